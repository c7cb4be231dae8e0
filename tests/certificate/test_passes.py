"""Correct axes pass, with figures near rounding, and the certificate is plain finite JSON."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from mat_core.certificate.report import CHECKS, LENGTH
from tests.certificate.accused import SHAPES, accused


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("name", SHAPES)
def test_correct_axis_passes(name: str, tolerance: float) -> None:
    a = accused(name, tolerance)
    certificate = a.judge()
    assert certificate["passed"], {n: c for n, c in certificate["checks"].items() if not c["passed"]}
    assert set(certificate["checks"]) == set(CHECKS) - (
        set() if len(a.curves.degree) else {"curves_ends", "curves_on_axis", "curves_empty"}
    )
    for check, found in certificate["checks"].items():
        if CHECKS[check].unit == LENGTH and check != "curves_tolerance":
            assert found["measured"] <= 1e-11, check


def test_is_plain_and_finite() -> None:
    certificate = accused("letter").judge()
    again = json.loads(json.dumps(certificate, allow_nan=False))
    assert again == certificate
    for found in again["checks"].values():
        assert set(found) == {"passed", "measured", "limit", "unit", "place", "detail"}
        assert found["place"] is None or all(math.isfinite(v) for v in found["place"])


def test_failing_one_is_plain_and_finite() -> None:
    a = accused("letter")
    disc = a.skeleton.disc.copy()
    disc[:] = np.nan
    certificate = a.with_discs(disc=disc).judge()
    assert not certificate["passed"]
    json.dumps(certificate, allow_nan=False)


def test_domain_is_optional() -> None:
    assert accused("letter")._replace(domain=None).judge()["passed"]


def test_judging_changes_nothing() -> None:
    a = accused("letter")
    before = [array.copy() for part in a[1:5] for array in part if isinstance(array, np.ndarray)]
    a.judge()
    after = [array for part in a[1:5] for array in part if isinstance(array, np.ndarray)]
    assert all(np.array_equal(x, y, equal_nan=True) for x, y in zip(before, after, strict=True))
