"""Is the axis that of the shape, wherever it lies and however its boundary is written down?

    python -m tests.hunt.invariance                               200 shapes that come with the tests, all changes
    python -m tests.hunt.invariance --changes far 'r*'            some of the changes (quoted patterns)
    python -m tests.hunt.invariance --fonts FOLDER --count 2      glyphs, icons, lines, families as for `tests.hunt`
    make invariance ARGS="--count 50"                             the same by make

Every shape is solved before and after each of `tests.changes.CHANGES`, and both answers are held to be the same axis by
`tests.sameness`: every node within 1e-9 of the size, the same segments between the same nodes, of the same kinds, as long but for
4e-9 of the size, and 4e-6 where they are fitted. A domain that is refused must be refused for the same reasons after a change.

A shape that comes out otherwise is made smaller while it does, and written to out/invariance as a line of domains; the journal
there has every figure. The exit code is 1 when there was one.
"""

from __future__ import annotations

import argparse
import fnmatch
import random
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib

from tests.assertions import Answer
from tests.changes import CHANGES, Changed, moved_back
from tests.families import CATALOGUE
from tests.hunt import outlines, report
from tests.hunt.__main__ import add_shapes, add_work, chosen, domains
from tests.hunt.journal import Journal
from tests.hunt.judge import Outcome, solved
from tests.hunt.run import Hunt, Named
from tests.hunt.team import Team
from tests.reference import Reference
from tests.sameness import Sameness, compare

Json = dict[str, Any]
Solution = tuple[Outcome, Json | None]
CORPUS = Path(__file__).parents[1] / "corpus" / "outlines.jsonl.gz"
FONTS = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
OF_EACH_FONT = 6
SHAPES = 200


@dataclass
class Invariance(Outcome):
    """What came of a domain and all changes of it.

    Parameters
    ----------
    figures : dict
        By change: largest distance of a node and of a curve, largest difference of two lengths, as in `sameness.Sameness`.
    faults : dict
        By change: what was different.
    """

    figures: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    faults: dict[str, list[str]] = field(default_factory=dict)


def judged(domain: Json, changes: tuple[str, ...]) -> tuple[Outcome, Json | None]:
    """A domain solved before and after each change."""
    base = solved(domain)
    if base[0].bad:
        return base[0], None
    told = Invariance(**asdict(base[0]))
    for name in changes:
        same = same_after(domain, base, CHANGES[name](domain))
        told.figures[name] = (same.nodes, same.curves, same.lengths)
        if same.differences:
            told.faults[name] = same.differences
    if told.faults:
        first = next(iter(told.faults))
        told.category, told.kind = "wrong", f"{first}: {told.faults[first][0].split(':')[0]}"
        told.text = "; ".join(f"{name}: {', '.join(faults)}" for name, faults in told.faults.items())
    return told, None


def same_after(domain: Json, base: Solution, changed: Changed) -> Sameness:
    """The answer after a change against the first of the answers before it that it agrees with, else the first of all."""
    outcome, answer = solved(changed.after)
    found: list[Sameness] = []
    for before in changed.before:
        first, known = base if before is domain else solved(before)
        if answer is None or known is None:
            refused = first.category == "invalid" and outcome.same(first)
            found.append(Sameness(differences=[] if refused else [f"{outcome.category}: {outcome.text or 'was ' + first.text}"]))
        else:
            frame = Reference(before)
            found.append(compare(Answer(known, frame), Answer(moved_back(answer, changed), frame)))
        if not found[-1].differences:
            return found[-1]
    return found[0]


# What is tried -------------------------------------------------------------------------------------------------------
def own_shapes(count: int, seed: int) -> list[Named]:
    """Some of the shapes that come with the tests: analytic ones, outlines of the corpus, glyphs of matplotlib's fonts."""
    shapes: list[Named] = [(f"analytic/{name}", build()) for name, build in CATALOGUE.items()]
    shapes += outlines.lines(CORPUS)
    for file in outlines.files([str(FONTS)], outlines.FONT_FILES):
        shapes += (g for g in outlines.glyphs(file, OF_EACH_FONT, seed) if g[0].endswith("#0"))
    random.Random(seed).shuffle(shapes)
    return shapes[: count or None]


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """What was asked for."""
    p = argparse.ArgumentParser(
        prog="python -m tests.hunt.invariance",
        description="Look for shapes whose axis depends on their place, unit or description; without more, those of the tests.",
    )
    add_shapes(p, SHAPES)
    add_work(p, 120.0, "out/invariance")
    p.add_argument("--changes", nargs="+", metavar="NAME", default=["*"], help=f"of {', '.join(CHANGES)}; patterns allowed")
    return p.parse_args(given)


def chosen_changes(patterns: list[str]) -> tuple[str, ...]:
    """The changes that were asked for."""
    names = tuple(c for c in CHANGES if any(fnmatch.fnmatch(c, pattern) for pattern in patterns))
    if not names:
        raise SystemExit(f"no such change; there are {', '.join(CHANGES)}")
    return names


# What is told --------------------------------------------------------------------------------------------------------
def table(outcomes: Mapping[str, Outcome], changes: tuple[str, ...]) -> str:
    """One row a change: shapes, how many differ, the worst distance of nodes and difference of lengths, and whose these are."""
    tried = {name: o for name, o in outcomes.items() if isinstance(o, Invariance)}
    rows = [f"{'change':14s} {'shapes':>6s} {'differ':>6s} {'nodes':>8s} {'lengths':>8s}  worst by nodes, by lengths"]
    for change in changes:
        differ = sum(change in o.faults for o in tried.values())
        figures = [(*o.figures[change], name) for name, o in tried.items()]
        nodes, _, _, far = max(figures, default=(0.0, 0.0, 0.0, "none"))
        lengths, other = max(((f[2], f[3]) for f in figures), default=(0.0, "none"))
        rows.append(f"{change:14s} {len(tried):6d} {differ:6d} {nodes:8.1e} {lengths:8.1e}  {far}, {other}")
    return "\n".join(rows)


def main(given: list[str] | None = None) -> int:
    """Try and tell; 1 when anything differed or was not solved."""
    a = arguments(given)
    changes = chosen_changes(a.changes)
    others = a.only or a.fonts or a.icons or a.lines
    shapes = list(domains(a, chosen(a)) if others else own_shapes(a.count, a.seed))
    sys.stdout.write("loading the kernels\n")
    sys.stdout.flush()
    from mat_core import warm

    warm()
    journal = Journal(a.out / "journal.jsonl")
    team = Team(a.workers, a.limit, partial(judged, changes=changes))
    hunt = Hunt(team, journal, a.out, 0.0, a.reduce, a.reduce_seconds)
    try:
        hunt.run(shapes, report.Progress(len(shapes)))
    except KeyboardInterrupt:
        sys.stdout.write("stopped\n")
    finally:
        team.stop()
        journal.close()
    told = [report.table(journal.outcomes), report.kinds(journal.outcomes), table(journal.outcomes, changes)]
    sys.stdout.write("\n\n".join(part for part in told if part) + "\n")
    return int(report.failed(journal.outcomes))


if __name__ == "__main__":
    raise SystemExit(main())
