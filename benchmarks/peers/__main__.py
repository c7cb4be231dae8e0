"""`python -m benchmarks.peers [--only TEXT] [--minutes N]`: ours and its peers on the same shapes, in one run.

A full run writes docs/performance.md and its pictures; one that is restricted by --only prints, and writes nothing.
"""

from __future__ import annotations

import argparse
import os
import time

os.environ.setdefault("NUMBA_NUM_THREADS", "1")  # one thread for all: set before anything of ours is loaded
os.environ.setdefault("OMP_NUM_THREADS", "1")

from benchmarks.peers import document
from benchmarks.peers.cases import cases
from benchmarks.peers.environment import peers
from benchmarks.peers.solve import Row, solve

MINUTES = 15.0  # of comparisons; cases that would begin later are left out


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument("--only", default="", help="cases whose group, name or tolerance contains this")
    parser.add_argument("--minutes", type=float, default=MINUTES, help="no case begins after so many")
    chosen = parser.parse_args()
    found, missing = peers()
    for peer in found:
        print(f"{peer.name} {peer.version}")
    for name, reason in missing.items():
        print(f"SKIPPED {name}: {reason}")
    begun = time.monotonic()
    rows: list[Row] = []
    left_out = 0
    for case in cases():
        if chosen.only not in f"{case.group}/{case.label}":
            continue
        if time.monotonic() - begun > 60 * chosen.minutes:
            print(f"SKIPPED {case.label}: {chosen.minutes:g} minutes are over")
            left_out += 1
            continue
        rows.append(solve(case, found))
        print(document.line(rows[-1]), flush=True)
    if not chosen.only:
        document.write(rows, found, missing, left_out)


if __name__ == "__main__":
    main()
