"""Compile (or load) every kernel once, by solving small domains that reach them all.

``python -m mat_core.warm`` does it from the command line, for images.
"""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Callable

import numpy as np

from mat_core.boundary.sites import build_sites
from mat_core.certificate import certify
from mat_core.curves.assemble import build_axis
from mat_core.model.containment import inside_domain
from mat_core.model.domain import Domain
from mat_core.tolerances import LADDER
from mat_core.topology.building import build_skeleton
from mat_core.topology.graph import build_graph

STAGES = ("validation", "sites", "skeleton", "graph", "curves", "certificate", "footpoints")


def example() -> dict[str, object]:
    """A domain with a line, a circular arc, a polynomial and a rational spiral, a reflex vertex and a hole."""
    half = 0.5**0.5
    outer = [
        {"degree": 1, "control_points": [[0, 0], [4, 0]]},
        {"degree": 2, "control_points": [[4, 0], [5, 0], [5, 1]], "weights": [1, half, 1]},
        {"degree": 3, "control_points": [[5, 1], [5, 2], [4, 3], [3, 3]]},
        {"degree": 1, "control_points": [[3, 3], [3, 2]]},
        {"degree": 1, "control_points": [[3, 2], [1, 2]]},
        {"degree": 2, "control_points": [[1, 2], [0, 2], [0, 0]], "weights": [1, 2, 1]},
    ]
    hole = [
        {"degree": 1, "control_points": [[2.0, 0.8], [2.0, 1.2]]},
        {"degree": 1, "control_points": [[2.0, 1.2], [2.4, 1.0]]},
        {"degree": 1, "control_points": [[2.4, 1.0], [2.0, 0.8]]},
    ]
    return {"outer": outer, "holes": [hole]}


def warm(progress: Callable[[str, int, int], None] | None = None) -> None:
    """Compile or load every kernel, so that the next solution is fast.

    Parameters
    ----------
    progress : callable, optional
        Called with (stage, number of this stage, number of stages) before each one.
    """

    def tell(number: int) -> None:
        if progress is not None:
            progress(STAGES[number], number + 1, len(STAGES))

    # The compiler makes millions of small objects that live on: collecting in between costs a tenth of the time.
    collecting = gc.isenabled()
    gc.disable()
    try:
        _solve_example(tell)
    finally:
        if collecting:
            gc.enable()


def _solve_example(tell: Callable[[int], None]) -> None:
    """Every stage once, each announced."""
    rung = LADDER[0]
    tell(0)
    domain = Domain.from_dict(example())
    tell(1)
    table = build_sites(domain, 1e-6, rung)
    tell(2)
    skeleton = build_skeleton(table, rung)
    tell(3)
    skeleton, graph = build_graph(table, skeleton, rung)
    tell(4)
    axis = build_axis(domain, table, skeleton, graph, 1e-6, None)
    tell(5)
    axis = axis.with_certificate(certify(table, skeleton, graph, axis.curves, 1e-6, domain=domain))
    tell(6)
    axis.to_json(samples=True)
    axis.evaluate(np.zeros(1, dtype=np.int64), np.zeros(1))
    inside_domain(domain, np.zeros((1, 2)))


def main() -> None:
    """Command line: one line a stage, and how long it took."""
    begun = time.monotonic()

    def line(stage: str, number: int, stages: int) -> None:
        sys.stdout.write(f"kernels {number}/{stages}: {stage}\n")
        sys.stdout.flush()

    warm(line)
    sys.stdout.write(f"kernels ready after {time.monotonic() - begun:.1f} s\n")


if __name__ == "__main__":
    main()
