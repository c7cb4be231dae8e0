"""Command line of the hunt, see `tests.hunt`."""

from __future__ import annotations

import argparse
import fnmatch
import sys
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from tests.hunt import outlines, report
from tests.hunt.draw import FAMILIES, draw
from tests.hunt.journal import Journal
from tests.hunt.run import Hunt, Named, placed
from tests.hunt.team import Team


def pair(text: str) -> tuple[float, float]:
    """Two numbers with a comma between them."""
    x, y = text.split(",")
    return float(x), float(y)


def add_shapes(p: argparse.ArgumentParser, count: int) -> None:
    """Arguments that say which domains."""
    p.add_argument("--only", nargs="+", metavar="FAMILY", help="generated families, patterns allowed")
    p.add_argument("--count", type=int, default=count, help="domains per family, glyphs per font, icons per folder (0: all)")
    p.add_argument("--seed", type=int, default=0, help="the first seed of each family, and what chooses glyphs and icons")
    p.add_argument("--fonts", nargs="+", default=[], metavar="PLACE", help="font files, or folders of them")
    p.add_argument("--icons", nargs="+", default=[], metavar="FOLDER", help="folders of SVG icons")
    p.add_argument("--lines", nargs="+", default=[], metavar="FILE", help="files of domains, one a line")


def add_work(p: argparse.ArgumentParser, limit: float, out: str) -> None:
    """Arguments that say how, and what becomes of failures."""
    p.add_argument("--workers", type=int, default=2, help="processes (2)")
    p.add_argument("--limit", type=float, default=limit, help=f"seconds per domain ({limit:g})")
    p.add_argument("--reduce", type=int, default=3, metavar="N", help="failures reduced per family and kind (3)")
    p.add_argument("--reduce-seconds", type=float, default=60.0, metavar="S", help="longest time for one of them (60)")
    p.add_argument("--out", type=Path, default=Path(out), help=f"folder for the journal and the failures ({out})")


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """What was asked for."""
    p = argparse.ArgumentParser(
        prog="python -m tests.hunt",
        description="Look for domains that are not solved: of all generated families, or of those, fonts, icons and lines given.",
    )
    add_shapes(p, 100)
    add_work(p, 20.0, "out/hunt")
    p.add_argument("--oracle", type=float, default=0.1, metavar="SHARE", help="share compared with the oracle (0.1)")
    p.add_argument("--scale", type=float, default=1.0, help="factor on all coordinates")
    p.add_argument("--shift", type=pair, default=(0.0, 0.0), metavar="DX,DY", help="then moved by; --shift=-1e6,0 if negative")
    p.add_argument("--resume", action="store_true", help="go on with the journal")
    p.add_argument("--worst", action="store_true", help="list the hundred slowest for their size, and largest in memory")
    return p.parse_args(given)


def chosen(a: argparse.Namespace) -> list[str]:
    """The generated families that were asked for."""
    if a.only is None:
        return [] if a.fonts or a.icons or a.lines else list(FAMILIES)
    names = [f for f in FAMILIES if any(fnmatch.fnmatch(f, pattern) for pattern in a.only)]
    if not names:
        raise SystemExit(f"no such family; there are {', '.join(FAMILIES)}")
    return names


def domains(a: argparse.Namespace, families: list[str]) -> Iterator[Named]:
    """Everything that was asked for; seed by seed, so that each family has its turn early."""
    generated = ((f"{f}/{s}", draw(f, s)) for s in range(a.seed, a.seed + a.count) for f in families)
    glyphs = (g for file in outlines.files(a.fonts, outlines.FONT_FILES) for g in outlines.glyphs(file, a.count, a.seed))
    icons = (i for folder in a.icons for i in outlines.icons(folder, a.count, a.seed))
    lines = (d for file in outlines.files(a.lines, ()) for d in outlines.lines(file))
    return chain(generated, glyphs, icons, lines)


def main(given: list[str] | None = None) -> int:
    """Hunt and tell; 1 when anything failed."""
    a = arguments(given)
    families = chosen(a)
    total = len(families) * a.count if not (a.fonts or a.icons or a.lines) else None
    sys.stdout.write("loading the kernels\n")
    sys.stdout.flush()
    from mat_core import warm

    warm()
    journal, team = Journal(a.out / "journal.jsonl", a.resume), Team(a.workers, a.limit)
    hunt = Hunt(team, journal, a.out, a.oracle, a.reduce, a.reduce_seconds)
    try:
        hunt.run(placed(domains(a, families), a.scale, a.shift), report.Progress(total))
    except KeyboardInterrupt:
        sys.stdout.write("stopped; --resume goes on from here\n")
    finally:
        team.stop()
        journal.close()
    parts = [report.table(journal.outcomes), report.kinds(journal.outcomes)]
    sys.stdout.write("\n\n".join([*parts, report.worst(journal.outcomes)] if a.worst else parts) + "\n")
    return int(report.failed(journal.outcomes))


if __name__ == "__main__":
    raise SystemExit(main())
