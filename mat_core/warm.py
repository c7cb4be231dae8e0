"""Compile (or load) every kernel once, by solving a small domain that reaches them all.

``python -m mat_core.warm`` does it from the command line, for images. There a second process compiles the later half of the
stages meanwhile: what that half works on is found by the same kernels, uncompiled, in a fraction of a second.
"""

from __future__ import annotations

import gc
import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from mat_core.boundary.sites import SiteTable, build_sites
from mat_core.certificate import certify
from mat_core.curves.assemble import build_axis
from mat_core.errors import UnsupportedOption
from mat_core.kernels.jit import all_kept
from mat_core.model.containment import inside_domain
from mat_core.model.domain import Domain
from mat_core.tolerances import LADDER
from mat_core.topology.building import build_skeleton
from mat_core.topology.graph import build_graph
from mat_core.topology.skeleton import Skeleton

STAGES = ("validation", "sites", "skeleton", "graph", "curves", "certificate", "footpoints")
PARTS = ("all", "first", "later")
LATER_HALF, UNCOMPILED = "--later-half", "--uncompiled"  # for the command line: what other processes are asked for

Tell = Callable[[int], None]


class Solved(NamedTuple):
    """What the first half of the stages hands to the later one."""

    domain: Domain
    table: SiteTable
    skeleton: Skeleton


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


def warm(progress: Callable[[str, int, int], None] | None = None, part: str = "all") -> None:
    """Compile or load every kernel, so that the next solution is fast.

    Parameters
    ----------
    progress : callable, optional
        Called with (stage, number of this stage, number of stages) before each one.
    part : str
        "first" or "later": the kernels of this half of the stages only, for two processes that compile at the same time.

    Raises
    ------
    UnsupportedOption
        There is no such part.
    """
    if part not in PARTS:
        raise UnsupportedOption("part", f"{part!r} is not one of {', '.join(PARTS)}")

    def tell(number: int) -> None:
        if progress is not None:
            progress(STAGES[number], number + 1, len(STAGES))

    # The compiler makes millions of small objects that live on: collecting in between costs a tenth of the time.
    collecting = gc.isenabled()
    gc.disable()
    try:
        found = _found_uncompiled() if part == "later" else _first_half(tell)
        if part != "first":
            _later_half(found, tell)
    finally:
        if collecting:
            gc.enable()


def _first_half(tell: Tell) -> Solved:
    """From the input to the skeleton."""
    rung = LADDER[0]
    tell(0)
    domain = Domain.from_dict(example())
    tell(1)
    table = build_sites(domain, 1e-6, rung)
    tell(2)
    return Solved(domain, table, build_skeleton(table, rung))


def _later_half(found: Solved, tell: Tell) -> None:
    """From the graph to the answer."""
    domain, table, skeleton = found
    tell(3)
    skeleton, graph = build_graph(table, skeleton, LADDER[0])
    tell(4)
    axis = build_axis(domain, table, skeleton, graph, 1e-6, None)
    tell(5)
    axis = axis.with_certificate(certify(table, skeleton, graph, axis.curves, 1e-6, domain=domain))
    tell(6)
    axis.to_json(samples=True)
    axis.evaluate(np.zeros(1, dtype=np.int64), np.zeros(1))
    inside_domain(domain, np.zeros((1, 2)))


def halves() -> tuple[str, ...]:
    """Parts of `warm` that are worth a process each: none when every kernel is there."""
    return () if all_kept() else PARTS[1:]


def _found_uncompiled() -> Solved:
    """The first half's results, from a process that compiles nothing."""
    with _this_module(UNCOMPILED, stdout=subprocess.PIPE, env={**os.environ, "NUMBA_DISABLE_JIT": "1"}) as other:
        return Solved(*pickle.loads(other.communicate()[0]))


def _this_module(what: str, **options: Any) -> subprocess.Popen[bytes]:
    """This module's command line in another process."""
    return subprocess.Popen([sys.executable, "-W", "ignore", "-m", "mat_core.warm", what], **options)


# Command line --------------------------------------------------------------------------------------------------------
def main() -> None:
    """Both halves at a time, a line for each stage, and how long it took."""
    if UNCOMPILED in sys.argv:
        sys.stdout.buffer.write(pickle.dumps(tuple(_first_half(lambda number: None))))
    elif LATER_HALF in sys.argv:
        warm(_line, "later")
    else:
        begun = time.monotonic()
        if halves():
            with _this_module(LATER_HALF):
                warm(_line, "first")
            warm()  # loads all, and compiles what the other process did not
        else:
            warm(_line)
        sys.stdout.write(f"kernels ready after {time.monotonic() - begun:.1f} s\n")


def _line(stage: str, number: int, stages: int) -> None:
    sys.stdout.write(f"kernels {number}/{stages}: {stage}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
