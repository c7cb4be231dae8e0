"""What mat_core refuses, as errors of the service with all their problems and places."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import mat_core
from service.errors import RequestError

MAX_PROBLEMS = 1000
"""Problems listed in one answer; a body of garbage would otherwise be answered by a larger one."""


def invalid(found: list[mat_core.Problem]) -> RequestError:
    """The answer to an invalid domain: all its problems, as far as a person would read them."""
    count = len(found)
    problems = [problem.to_dict() for problem in found[:MAX_PROBLEMS]]
    too_complex = all(problem["code"] == "too-complex" for problem in problems)
    detail = "1 problem, see problems." if count == 1 else f"{count} problems, see problems."
    if count > MAX_PROBLEMS:
        detail += f" The first {MAX_PROBLEMS} are listed."
    return RequestError("too-complex" if too_complex else "invalid-domain", detail, {"problems": problems})


def check_edges(content: Any, most: int) -> None:
    """Refuse a domain of too many edges before any of them is looked at."""
    holes = content.get("holes") if isinstance(content, dict) else None
    loops = [content.get("outer"), *(holes if isinstance(holes, list) else [])] if isinstance(content, dict) else []
    count = sum(len(loop) for loop in loops if isinstance(loop, list))
    if count > most:
        text = f"the boundary has {count} edges; at most {most} are accepted. Simplify it, or cut it into parts"
        raise invalid([mat_core.Problem("too-complex", "", text)])


@contextlib.contextmanager
def refusals(member: str) -> Iterator[None]:
    """Turn what the library raises while it computes into errors of the service; `member` of the body holds what was asked."""
    try:
        yield
    except mat_core.UnsupportedOption as refusal:
        raise _unsupported(refusal, member) from refusal
    except mat_core.NotCertified as failure:
        raise _not_certified(failure) from failure


def _unsupported(refusal: mat_core.UnsupportedOption, member: str) -> RequestError:
    """The answer to options or arguments that are well formed one by one but do not go together, or with this domain."""
    problem = {"code": "unsupported-option", "pointer": f"{member}/{refusal.option}", "message": str(refusal)}
    return RequestError("invalid-domain", "1 problem, see problems.", {"problems": [problem]})


def _not_certified(failure: mat_core.NotCertified) -> RequestError:
    """The answer that withholds a result: which check failed, where, and all figures of the failed certificate."""
    problem: dict[str, Any] = {"code": "not-certified", "pointer": "", "message": failure.detail}
    if failure.place is not None:
        problem["x"], problem["y"] = failure.place
    return RequestError("not-certified", str(failure), {"problems": [problem], "certificate": failure.certificate})
