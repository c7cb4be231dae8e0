"""Every document that a test of this folder hands to `Domain` is judged twice.

What `mat_core.model.survey` measures proves most rules kept; where it proves nothing, every edge is looked at by itself. Both
ways must come to the same domain, or to the same problems in the same words.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from mat_core.errors import InvalidDomain
from mat_core.model import domain, problems
from mat_core.model.problems import Checked
from mat_core.model.reading import Draft, read

Check = Callable[[object, int], Checked]


def read_unproved(obj: object, limit: int) -> Draft:
    """What is read, with all that may be proved of it taken back."""
    draft = read(obj, limit)
    draft.seen = draft.seen._replace(sound=False, least_extent=0.0, widest_gap=math.inf)
    return draft


def outcome(check: Check, obj: object, limit: int) -> Checked | InvalidDomain:
    """The domain or its refusal."""
    try:
        return check(obj, limit)
    except InvalidDomain as refused:
        return refused


def assert_alike(a: Checked | InvalidDomain, b: Checked | InvalidDomain) -> None:
    """The same domain, number by number, or the same problems."""
    if isinstance(a, InvalidDomain):
        assert isinstance(b, InvalidDomain)
        assert repr(a.problems) == repr(b.problems)  # some of their numbers are none
        return
    assert isinstance(b, Checked), b
    for mine, other in ((a.arrays, b.arrays), (a.given, b.given)):
        assert all(np.array_equal(p, q) for p, q in zip(mine, other, strict=True))
    assert np.array_equal(a.outline.measures, b.outline.measures)
    assert (a.outline.frame, a.options, a.notes) == (b.outline.frame, b.options, b.notes)


@pytest.fixture(autouse=True)
def judged_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `Domain.from_dict` compare both ways."""
    check = problems.check

    def both_ways(obj: object, limit: int) -> Checked:
        found = outcome(check, obj, limit)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(problems, "read", read_unproved)
            assert_alike(found, outcome(check, obj, limit))
        if isinstance(found, InvalidDomain):
            raise found
        return found

    monkeypatch.setattr(domain, "check", both_ways)
