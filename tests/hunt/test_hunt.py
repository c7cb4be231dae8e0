"""A fixed small share of the hunt: every generated family, some of them before the oracle."""

from __future__ import annotations

import pytest

from tests.hunt.draw import FAMILIES, draw
from tests.hunt.judge import compared, solved

SEEDS = range(11)  # every noise level once


@pytest.mark.parametrize("family", FAMILIES)
def test_solved(family: str) -> None:
    outcomes = {seed: solved(draw(family, seed))[0] for seed in SEEDS}
    assert {s: o.text for s, o in outcomes.items() if o.category != "certified"} == {}


@pytest.mark.parametrize("family", list(FAMILIES)[::3])
def test_agrees_with_the_oracle(family: str) -> None:
    domain = draw(family, SEEDS[0])
    outcome, answer = solved(domain)
    assert answer is not None, outcome.text
    judged = compared(domain, answer, outcome)
    assert judged.oracle
    assert judged.category == "certified", judged.text


@pytest.mark.parametrize("family", FAMILIES)
def test_a_seed_says_the_domain(family: str) -> None:
    assert draw(family, 3) == draw(family, 3)
    assert draw(family, 3) != draw(family, 4)
