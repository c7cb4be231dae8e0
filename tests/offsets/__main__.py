"""Command line of the comparison, see `tests.offsets`."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from itertools import chain

from mat_core import InvalidDomain, MatError
from tests.hunt import outlines
from tests.offsets.check import AGREES, OUTWARD, SHARES, Checked, Json, check
from tests.offsets.shapes import shapes


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """What was asked for."""
    p = argparse.ArgumentParser(prog="python -m tests.offsets", description="Hold offsets against shapely's buffer.")
    p.add_argument("--count", type=int, default=10, help="glyphs per font, icons per folder (0: all)")
    p.add_argument("--seed", type=int, default=0, help="what chooses glyphs and icons")
    p.add_argument("--fonts", nargs="+", default=[], metavar="PLACE", help="font files, or folders of them")
    p.add_argument("--icons", nargs="+", default=[], metavar="FOLDER", help="folders of SVG icons")
    p.add_argument("--lines", nargs="+", default=[], metavar="FILE", help="files of domains, one a line")
    p.add_argument("--outward", action="store_true", help="outward, too")
    return p.parse_args(given)


def chosen(a: argparse.Namespace) -> Iterator[tuple[str, Json]]:
    """Names and domains."""
    glyphs = (g for file in outlines.files(a.fonts, outlines.FONT_FILES) for g in outlines.glyphs(file, a.count, a.seed))
    icons = (i for folder in a.icons for i in outlines.icons(folder, a.count, a.seed))
    lines = (d for file in outlines.files(a.lines, ()) for d in outlines.lines(file))
    return chain(glyphs, icons, lines) if a.fonts or a.icons or a.lines else iter(shapes())


def main(given: list[str] | None = None) -> int:
    """Compare and tell; 1 when anything is wrong."""
    a = arguments(given)
    done: list[Checked] = []
    domains = invalid = failed = 0
    began = time.process_time()
    for name, shape in chosen(a):
        try:
            found = list(check(name, shape, SHARES + OUTWARD if a.outward else SHARES))
        except InvalidDomain:
            invalid += 1
            continue
        except MatError as error:
            failed += 1
            sys.stdout.write(f"{name}: {type(error).__name__}: {error}\n")
            continue
        domains += 1
        done += found
        for c in found:
            for problem in c.problems:
                sys.stdout.write(f"{name} at {c.share}: {problem}; off {c.miss:.1e}, known to {c.doubt:.1e}\n")
        sys.stdout.flush()
    wrong = sum(bool(c.problems) for c in done)
    sys.stdout.write(
        f"{domains} domains ({invalid} invalid, {failed} not solved or refused), {len(done)} offsets in "
        f"{time.process_time() - began:.0f} s of processor: {wrong} wrong; areas, relative to the domain's: largest difference "
        f"{max((abs(c.miss) for c in done), default=0.0):.1e} (promised {AGREES:g}), reference known to "
        f"{max((c.doubt for c in done), default=0.0):.1e}; beyond its bounds {max((c.beyond for c in done), default=0.0):.1e}; "
        f"regions and loops counted: {sum(c.known for c in done)}\n"
    )
    return int(bool(wrong or failed))


if __name__ == "__main__":
    raise SystemExit(main())
