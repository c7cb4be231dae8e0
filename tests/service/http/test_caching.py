from __future__ import annotations

import asyncio

import pytest
from starlette.datastructures import Headers

from service.errors import RequestError
from service.http.caching import INLINE_BYTES, Kept, ResultCache, content_tag, digest, tag, unchanged

TAG = content_tag(b"a document")


def of(body: bytes, **order: object) -> str:
    return asyncio.run(digest(body, **order))


def kept(size: int) -> Kept:
    return Kept((b"x" * size,), {}, "application/json")


def test_everything_that_decides_an_answer_is_in_its_hash() -> None:
    base = {"operation": "mat", "format": "json", "precision": None, "algorithm": "1"}
    changed = [{"operation": "width"}, {"format": "svg"}, {"precision": 6}, {"algorithm": "2"}]
    hashes = {of(b"{}", **base), of(b"{ }", **base), *(of(b"{}", **(base | change)) for change in changed)}
    assert len(hashes) == 2 + len(changed)
    assert of(b"{}", **base) == of(b"{}", **dict(reversed(base.items())))


def test_what_was_ordered_cannot_be_smuggled_in_by_the_body() -> None:
    assert of(b"", a=1) != of(b'{"a": 1}\n')


def test_a_large_body_is_hashed_as_a_small_one_would_be() -> None:
    body = b"x" * (2 * INLINE_BYTES)
    assert of(body) != of(body[:-1] + b"y")


@pytest.mark.parametrize("header", [TAG, TAG.removeprefix("W/"), f'"a", {TAG}', f'W/"a,b",{TAG} , "c"', "*", " * "])
def test_a_document_that_the_client_has(header: str) -> None:
    headers = Headers({"if-none-match": header})
    assert unchanged("GET", headers, TAG)
    assert unchanged("HEAD", headers, TAG)
    with pytest.raises(RequestError) as refusal:
        unchanged("POST", headers, TAG)
    assert refusal.value.code == "precondition-failed"
    assert refusal.value.headers["ETag"] == TAG


@pytest.mark.parametrize("header", ['"a"', 'W/"a"', "", "nonsense", TAG[:-2] + '"', TAG.removeprefix("W/").strip('"')])
def test_a_document_that_it_has_not(header: str) -> None:
    for method in ("GET", "POST"):
        assert not unchanged(method, Headers({"if-none-match": header}), TAG)


@pytest.mark.parametrize("header", [TAG, '"a"', "nonsense"])
def test_no_weak_tag_matches_strongly(header: str) -> None:
    with pytest.raises(RequestError) as refusal:
        unchanged("POST", Headers({"if-match": header}), TAG)
    assert refusal.value.code == "precondition-failed"


def test_any_version_matches() -> None:
    assert not unchanged("POST", Headers({"if-match": "*"}), TAG)


def test_a_tag_is_a_weak_one_of_a_hash() -> None:
    assert tag("0" * 64) == f'W/"{"0" * 32}"'


def test_the_store_is_bounded_and_drops_what_was_not_asked_for() -> None:
    store = ResultCache(1000)
    for name in "abcd":
        store.put(name, False, kept(250))
    assert store.get("a", False) is not None
    store.put("e", False, kept(250))
    assert [name for name in "abcde" if store.get(name, False)] == ["a", "c", "d", "e"]


def test_a_large_answer_does_not_drive_out_all_others() -> None:
    store = ResultCache(1000)
    store.put("a", False, kept(100))
    store.put("b", False, kept(251))
    assert store.get("a", False) is not None
    assert store.get("b", False) is None


def test_compressed_answers_are_others() -> None:
    store = ResultCache(1000)
    store.put("a", True, kept(1))
    assert store.get("a", False) is None


def test_a_store_of_no_size_keeps_nothing() -> None:
    store = ResultCache(0)
    store.put("a", False, kept(1))
    assert store.get("a", False) is None


def test_keeping_twice_counts_once() -> None:
    store = ResultCache(1000)
    for _ in range(9):
        store.put("a", False, kept(200))
    for name in "bcde":
        store.put(name, False, kept(200))
    assert all(store.get(name, False) for name in "abcde")
