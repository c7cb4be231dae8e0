"""A small selection of domains that together reach every kernel; as a program it prints their answers.

``python -m tests.kernels.answers`` is run by `test_modes` with Numba set in other ways.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np

from mat_core import Domain, InvalidDomain, medial_axis
from mat_core.kernels.curve import evaluate
from mat_core.warm import example
from tests.families import annulus, conic_loop, polyline, rounded_rectangle

Json = dict[str, Any]

SHAPES: dict[str, Json] = {
    "every kind of piece, a reflex vertex, a hole": example(),
    "ell": {"outer": polyline([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)])},
    "annulus": annulus(0.5),
    "ellipse": {"outer": [conic_loop(2.0, 1.0)]},
    "circle": {"outer": [conic_loop(1.0, 1.0)]},
    "rounded rectangle": rounded_rectangle(3.0, 2.0, 0.5),
    "bow tie": {"outer": polyline([(0, 0), (2, 1), (2, 0), (0, 1)])},
}


def answer(shape: Json) -> Json:
    """The answer document with samples; the codes and places of the problems when the domain is not valid."""
    try:
        domain = Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])})
    except InvalidDomain as refused:
        return {"problems": [[problem.code, problem.x, problem.y] for problem in refused.problems]}
    document: Json = json.loads(medial_axis(domain).to_json(samples=True))
    return document


def refuses_beyond_the_end() -> bool:
    """Whether a kernel that is asked for a site beyond the end of the table says so: indices are looked at."""
    sites, figures, points = np.zeros((1, 12), dtype=np.int64), np.zeros((1, 26)), np.zeros((1, 3))
    try:
        evaluate(sites, figures, points, 1, 0.5, 0.0, 0.0)
    except IndexError:
        return True
    return False


if __name__ == "__main__":
    json.dump({"bounded": refuses_beyond_the_end(), "answers": {k: answer(v) for k, v in SHAPES.items()}}, sys.stdout)
