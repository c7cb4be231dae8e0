"""What a change of the OpenAPI document breaks for clients that were written against an earlier one.

``python tools/breaking.py OLD.json NEW.json`` prints a line for each break and ends with code 1 if there is one.

Two rules, by one comparison of schemas, `outside`: whatever could be sent before can be sent now (the old request lies within
the new one), and whatever is answered now could be answered before (the new answer lies within the old one). So a new optional
member of a request is harmless, and a new required one is not; of an answer it is the other way round. The comparison goes
keyword by keyword and doubts what it cannot tell: a change that it reports may be harmless, one that it passes is.
Errors are left aside: codes may come and go with the reasons for them, and all are problem documents.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Json = dict[str, Any]

LOWER = ("minimum", "exclusiveMinimum", "minLength", "minItems", "minProperties")
UPPER = ("maximum", "exclusiveMaximum", "maxLength", "maxItems", "maxProperties")
SAME = ("pattern", "not", "format", "prefixItems", "uniqueItems", "multipleOf", "propertyNames")
"""Keywords that only narrow when they change: no order between their values is known here."""


def breaks(old: Json, new: Json) -> list[str]:
    """Everything that a client of `old` cannot rely on any more in `new`."""
    found = []
    for path, methods in old["paths"].items():
        for method, before in methods.items():
            after = new["paths"].get(path, {}).get(method)
            name = f"{method.upper()} {path}"
            if after is None:
                found.append(f"{name}: is gone")
                continue
            found += [f"{name}: {reason}" for reason in _operation(Comparison(old, new), before, after)]
    return found


def _operation(pair: Comparison, before: Json, after: Json) -> Iterator[str]:
    """What became of one operation."""
    if before.get("operationId") != after.get("operationId"):
        yield f"operationId {before.get('operationId')} became {after.get('operationId')}"
    if {} in before.get("security", [{}]) and {} not in after.get("security", [{}]):
        yield "needs a key now"
    yield from _parameters(pair, before, after)
    yield from _body(pair, before.get("requestBody"), after.get("requestBody"))
    for status, response in before["responses"].items():
        if int(status) >= 400:
            continue
        answer = after["responses"].get(status)
        if answer is None:
            yield f"answers {status} no more"
            continue
        for media_type, content in response.get("content", {}).items():
            if media_type not in answer.get("content", {}):
                yield f"answers {media_type} no more"
                continue
            new_schema = answer["content"][media_type].get("schema", {})
            for reason in pair.flipped().outside(new_schema, content.get("schema", {})):
                yield f"answer {status}: {reason}"


def _parameters(pair: Comparison, before: Json, after: Json) -> Iterator[str]:
    known = {(each["in"], each["name"]): each for each in before.get("parameters", ())}
    now = {(each["in"], each["name"]): each for each in after.get("parameters", ())}
    for key, parameter in now.items():
        if parameter.get("required", False) and not known.get(key, {}).get("required", False):
            yield f"parameter {key[1]}: must be given now"
    for key, parameter in known.items():
        if key not in now:
            yield f"parameter {key[1]}: is gone"
            continue
        for reason in pair.outside(parameter["schema"], now[key]["schema"]):
            yield f"parameter {key[1]}: {reason}"


def _body(pair: Comparison, before: Json | None, after: Json | None) -> Iterator[str]:
    if after is not None and after.get("required", False) and not (before or {}).get("required", False):
        yield "a body must be sent now"
    for media_type, content in (before or {}).get("content", {}).items():
        if media_type not in (after or {}).get("content", {}):
            yield f"takes {media_type} no more"
            continue
        assert after is not None
        for reason in pair.outside(content.get("schema", {}), after["content"][media_type].get("schema", {})):
            yield f"body: {reason}"


class Comparison:
    """Schemas of two documents: the inner one's, and those of the outer one that is to hold them."""

    def __init__(self, inner: Json, outer: Json) -> None:
        self._documents = inner, outer
        self._under_way: set[tuple[str, str]] = set()

    def flipped(self) -> Comparison:
        """The other way round."""
        inner, outer = self._documents
        return Comparison(outer, inner)

    def outside(self, inner: Any, outer: Any, place: str = "") -> Iterator[str]:
        """Why a value that fits `inner` may not fit `outer`."""
        names = (_name(inner), _name(outer))
        if names in self._under_way:
            return  # a schema that holds itself: it is being told already
        if all(names):
            self._under_way.add(names)
        inner, outer = (_resolved(schema, document) for schema, document in zip((inner, outer), self._documents, strict=True))
        yield from self._outside(inner, outer, place)
        self._under_way.discard(names)

    def _outside(self, inner: Any, outer: Any, place: str) -> Iterator[str]:
        """The same of schemas that are no references."""
        if outer in (True, {}) or inner is False:
            return
        if inner in (True, {}):
            yield f"{place or 'it'} may be anything now"
            return
        alternatives = inner.get("anyOf") or inner.get("oneOf")
        if alternatives:
            for alternative in alternatives:
                yield from self.outside(alternative, outer, place)
            return
        alternatives = outer.get("anyOf") or outer.get("oneOf")
        if alternatives:
            if all(list(self.outside(inner, alternative, place)) for alternative in alternatives):
                yield f"{place or 'it'} fits none of the alternatives"
            return
        yield from _values(inner, outer, place or "it")
        yield from self._members(inner, outer, place)

    def _members(self, inner: Json, outer: Json, place: str) -> Iterator[str]:
        """Items of lists, properties of objects."""
        if "items" in outer and "array" in _types(inner):
            yield from self.outside(inner.get("items", {}), outer["items"], f"{place}[]")
        if "object" not in _types(inner):
            return
        for name in outer.get("required", ()):
            if name not in inner.get("required", ()):
                yield f"{place}.{name} need not be there, and must"
        theirs, more = outer.get("properties", {}), outer.get("additionalProperties", True)
        own, own_more = inner.get("properties", {}), inner.get("additionalProperties", True)
        for name in [*own, *(name for name in theirs if name not in own)]:
            schema = own.get(name, own_more)
            if schema is False:
                continue
            if name not in theirs and more is False:
                yield f"{place}.{name} is not known"
            else:
                yield from self.outside(schema, theirs.get(name, more), f"{place}.{name}")
        if own_more is not False:
            if more is False:
                yield f"{place or 'it'} may have members that are not known"
            else:
                yield from self.outside(own_more, more, f"{place}.*")


def _values(inner: Json, outer: Json, place: str) -> Iterator[str]:
    """Why single values may not fit."""
    if not _types(inner) <= _types(outer) | ({"integer"} if "number" in _types(outer) else set()):
        yield f"{place} is {'/'.join(sorted(_types(inner)))}, not {'/'.join(sorted(_types(outer)))}"
    allowed, possible = _enumeration(outer), _enumeration(inner)
    if allowed is not None and (possible is None or any(value not in allowed for value in possible)):
        extra = "anything" if possible is None else [value for value in possible if value not in allowed]
        yield f"{place} may be {extra}, beyond {allowed}"
    if possible is not None:
        return  # bounds say nothing of values that are listed
    for keyword in LOWER:
        if keyword in outer and (keyword not in inner or inner[keyword] < outer[keyword]):
            yield f"{place}: {keyword} {outer[keyword]}, was {inner.get(keyword)}"
    for keyword in UPPER:
        if keyword in outer and (keyword not in inner or inner[keyword] > outer[keyword]):
            yield f"{place}: {keyword} {outer[keyword]}, was {inner.get(keyword)}"
    for keyword in SAME:
        if keyword in outer and inner.get(keyword) != outer[keyword]:
            yield f"{place}: {keyword} {outer[keyword]!r}, was {inner.get(keyword)!r}"


ALL_TYPES = frozenset(("array", "boolean", "integer", "null", "number", "object", "string"))


def _types(schema: Json) -> frozenset[str]:
    """The types that a schema allows."""
    given = schema.get("type", ALL_TYPES)
    return frozenset([given]) if isinstance(given, str) else frozenset(given)


def _enumeration(schema: Json) -> list[Any] | None:
    """The values that a schema lists."""
    if "const" in schema:
        return [schema["const"]]
    return schema.get("enum")


def _name(schema: Any) -> str:
    """The name that a schema refers to."""
    return schema.get("$ref", "") if isinstance(schema, dict) else ""


def _resolved(schema: Any, document: Json) -> Any:
    """What a reference leads to."""
    while _name(schema):
        schema = document["components"]["schemas"][_name(schema).rpartition("/")[2]]
    return schema


def main() -> int:
    """Compare two files."""
    old, new = (json.loads(Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:3])
    found = breaks(old, new)
    print("\n".join(found) or "nothing breaks")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
