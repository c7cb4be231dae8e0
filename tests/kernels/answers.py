"""A small selection of domains that together reach every kernel; as a program it prints their answers.

``python -m tests.kernels.answers`` is run by `test_modes` with Numba set in other ways.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from mat_core import Domain, medial_axis
from mat_core.kernels.curve import evaluate
from mat_core.warm import example
from tests.families import annulus, conic_loop, line, polyline, rounded_rectangle

Json = dict[str, Any]

SHAPES: dict[str, Json] = {
    "all kinds of pieces, a reflex vertex, a hole": example(),
    "ell": {"outer": polyline([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)])},
    "annulus": annulus(0.5),
    "ellipse": {"outer": [conic_loop(2.0, 1.0)]},
    "circle": {"outer": [conic_loop(1.0, 1.0)]},
    "rounded rectangle": rounded_rectangle(3.0, 2.0, 0.5),
    "invalid: crosses itself": {"outer": [line(*ends) for ends in (((0, 0), (1, 1)), ((1, 1), (1, 0)), ((1, 0), (0, 0.5)))]},
}


def answers() -> dict[str, Json]:
    """The answer document of each shape, with samples."""
    documents = {}
    for name, shape in SHAPES.items():
        domain = Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])})
        documents[name] = json.loads(medial_axis(domain).to_json(samples=True))
    return documents


if __name__ == "__main__":
    json.dump(answers(), sys.stdout)
