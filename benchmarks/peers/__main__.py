"""`python -m benchmarks.peers [--only TEXT] [--minutes N] [--rewrite]`: ours and its peers on the same shapes, in one run.

A full run writes docs/performance.md and its pictures; one that is restricted by --only prints, and writes nothing.
--rewrite writes the document from the figures of the last full run.
"""

from __future__ import annotations

import argparse
import os
import time

os.environ["MAT_CORE_THREADS"] = "1"  # one thread for all: set before anything of ours is loaded
os.environ["OMP_NUM_THREADS"] = "1"

from benchmarks import growth, resources
from benchmarks.fonts import fonts
from benchmarks.peers import document
from benchmarks.peers.cases import Case, cases
from benchmarks.peers.environment import peers
from benchmarks.peers.results import Results
from benchmarks.peers.solve import Row, solve
from benchmarks.resources import first_use, memory
from benchmarks.shapes import LARGE
from benchmarks.stages import Stages, run

MINUTES = 12.0  # of comparisons, cases that would begin later are left out; growth and profiles take three or four more
PROFILED = ("lines and arcs/rectangle", "curves/", "polygons/", "large/")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument("--only", default="", help="cases whose group/name tolerance contains this")
    parser.add_argument("--minutes", type=float, default=MINUTES, help="no case begins after so many")
    parser.add_argument("--rewrite", action="store_true", help="measure nothing, write the document from the last full run")
    chosen = parser.parse_args()
    if chosen.rewrite:
        document.write(Results.load_from())
        return
    found, missing = peers()
    for peer in found:
        print(f"{peer.name} {peer.version}", flush=True)
    for name, reason in missing.items():
        print(f"SKIPPED {name}: {reason}", flush=True)
    begun = time.monotonic()
    rows: list[Row] = []
    left_out: list[str] = []
    wanted = [case for case in cases() if chosen.only in f"{case.group}/{case.label}"]
    for number, case in enumerate(wanted, 1):
        if time.monotonic() - begun > 60 * chosen.minutes:
            print(f"SKIPPED {case.label}: {chosen.minutes:g} minutes are over")
            left_out.append(case.label)
            continue
        rows.append(solve(case, found))
        print(f"{number}/{len(wanted)} {document.line(rows[-1])}", flush=True)
    if not chosen.only:
        stages = Stages()
        families = [_grown(name, stages) for name in LARGE]
        profiles = {case.label: _profile(case, stages) for case in wanted if _profiled(case)}
        versions = {peer.name: peer.version for peer in found}
        memories = [memory(name) for name in resources.FAMILIES]
        results = Results(rows, families, profiles, versions, missing, left_out, fonts(), memories, first_use())
        results.save()
        document.write(results)


def _grown(name: str, stages: Stages) -> growth.Family:
    family = growth.grow(name, stages)
    print("\n".join(growth.table(family) if family.figures else [family.ended]), flush=True)
    return family


def _profile(case: Case, stages: Stages) -> dict[str, float]:
    print(f"stages of {case.label}", flush=True)
    return run(case.build(), stages, tolerance=case.tolerance)


def _profiled(case: Case) -> bool:
    return any(f"{case.group}/{case.label}".startswith(text) for text in PROFILED)


if __name__ == "__main__":
    main()
