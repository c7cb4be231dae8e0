"""Command line of the load, see `tests.load`."""

from __future__ import annotations

import argparse
import asyncio
import os
import sys
import tempfile
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

from tests.load.batch import batch, resumed
from tests.load.calm import beside_endless, beside_huge, calm, deadlines, overload
from tests.load.durability import database, disk, dismissed, killed
from tests.load.faults import faults
from tests.load.flood import flood
from tests.load.machines import machines
from tests.load.report import Report
from tests.load.scale import Scale, short

PARTS: dict[str, Callable[[Scale, Report], Awaitable[None]]] = {
    "calm": calm,
    "huge": beside_huge,
    "endless": beside_endless,
    "flood": flood,
    "overload": overload,
    "deadlines": deadlines,
    "faults": faults,
    "batch": batch,
    "resumed": resumed,
    "dismissed": dismissed,
    "killed": killed,
    "machines": machines,
    "database": database,
    "disk": disk,
}


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """What was asked for."""
    p = argparse.ArgumentParser(prog="python -m tests.load", description="Load and faults, and whether promises are kept.")
    p.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), help="parts; default: all")
    p.add_argument("--seconds", type=float, help="of each measurement")
    p.add_argument("--events", type=int, help="faults")
    p.add_argument("--lines", type=int, help="domains of a batch")
    p.add_argument("--rounds", type=int, help="times that a batch is measured beside bare processes")
    p.add_argument("--workers", type=int, help="processes that solve")
    p.add_argument("--huge-edges", type=int, help="of a huge domain")
    p.add_argument("--rate", type=float, help="small requests a second, where they come at a pace")
    p.add_argument("--short", action="store_true", help="a little of everything, with time to spare")
    p.add_argument("--folder", type=Path, help="for the log and the data of the service; default: one that is not kept")
    return p.parse_args(given)


async def run(parts: list[str], scale: Scale, tell: Callable[[str], object] = lambda _: None) -> Report:
    """Run parts one after the other."""
    report = Report()
    for part in parts:
        tell(f"{part} ...")
        await PARTS[part](scale, report)
    return report


def main() -> int:
    """Run what was asked for, print the table; 1 when a promise was broken."""
    asked = arguments()
    with tempfile.TemporaryDirectory() as folder:
        place = asked.folder or Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        scale = short(place) if asked.short else Scale(place)
        names = ("seconds", "events", "lines", "rounds", "workers", "huge_edges", "rate")
        chosen = {name: value for name in names if (value := getattr(asked, name)) is not None}
        load = os.getloadavg()[0]
        report = asyncio.run(run(asked.only, replace(scale, **chosen), lambda text: print(text, file=sys.stderr, flush=True)))
    print(report.table())
    print(f"load of the machine before and after: {load:.1f}, {os.getloadavg()[0]:.1f}; {os.cpu_count()} processors")
    return 1 if report.broken else 0


if __name__ == "__main__":
    sys.exit(main())
