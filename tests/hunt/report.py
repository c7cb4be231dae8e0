"""What a hunt tells: a line of progress, a table by family, and the worst by time and memory."""

from __future__ import annotations

import statistics
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Mapping
from typing import TextIO

import numpy as np

from tests.hunt.judge import BAD, CATEGORIES, Outcome

EVERY = 5.0  # seconds between lines where the output is no terminal
WORST = 100
Outcomes = Mapping[str, Outcome]


def family(name: str) -> str:
    """The family that a name begins with."""
    return name.split("/")[0]


class Progress:
    """One line, rewritten in place on a terminal, anew every few seconds elsewhere.

    Parameters
    ----------
    total : int, optional
        How many there will be, where it is known.
    out : file
    """

    def __init__(self, total: int | None = None, out: TextIO = sys.stdout) -> None:
        self.total, self.out = total, out
        self.begun = self.shown = time.monotonic()
        self.already: int | None = None

    def show(self, outcomes: Outcomes, reducing: int) -> None:
        """Tell how far it is, when it is time to."""
        now = time.monotonic()
        self.already = len(outcomes) if self.already is None else self.already
        if now - self.shown < (0.2 if self.out.isatty() else EVERY):
            return
        self.shown = now
        counts = Counter(o.category for o in outcomes.values())
        of = f"/{self.total}" if self.total else ""
        rate = (len(outcomes) - self.already) / (now - self.begun)
        latest = family(next(reversed(outcomes))) if outcomes else ""  # type: ignore[call-overload]
        text = "  ".join(f"{counts[c]} {c}" for c in CATEGORIES)
        line = f"{len(outcomes)}{of}  {text}  {reducing} being reduced  {rate:.0f}/s  {latest}"
        self.out.write(f"\r\x1b[K{line[:150]}" if self.out.isatty() else line + "\n")
        self.out.flush()

    def end(self) -> None:
        """Leave the line."""
        if self.out.isatty():
            self.out.write("\r\x1b[K")
            self.out.flush()


def table(outcomes: Outcomes) -> str:
    """One row a family, and one for all."""
    groups: dict[str, list[Outcome]] = defaultdict(list)
    for name, outcome in outcomes.items():
        groups[family(name)].append(outcome)
    rows = [_row(name, groups[name]) for name in sorted(groups)]
    if len(rows) > 1:
        rows.append(_row("all", list(outcomes.values())))
    head = f"{'family':32s} {'n':>6s}" + "".join(f" {c:>9s}" for c in CATEGORIES) + f" {'median ms':>10s} {'slowest ms':>11s}"
    return "\n".join([head, *rows])


def _row(name: str, outcomes: list[Outcome]) -> str:
    counts = Counter(o.category for o in outcomes)
    times = [o.ms for o in outcomes] or [0.0]
    figures = "".join(f" {counts[c]:9d}" for c in CATEGORIES)
    return f"{name[:32]:32s} {len(outcomes):6d}{figures} {statistics.median(times):10.1f} {max(times):11.1f}"


def kinds(outcomes: Outcomes) -> str:
    """How often each kind of failure and of refusal occurred, with an example."""
    seen: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name, outcome in outcomes.items():
        if outcome.category != "certified":
            seen[(outcome.category, outcome.kind)].append(name)
    rows = sorted(seen.items(), key=lambda item: (item[0][0], -len(item[1])))
    return "\n".join(f"{category:8s} {len(names):6d}  {kind:60s} {names[0]}" for (category, kind), names in rows)


def worst(outcomes: Outcomes, count: int = WORST) -> str:
    """The slowest for their number of pieces, and the largest in memory."""
    known = {name: o for name, o in outcomes.items() if o.ms > 0 and o.pieces > 0}
    if not known:
        return "nothing was solved"
    size = np.log([o.pieces for o in known.values()])
    spent = np.log([o.ms for o in known.values()])
    slope, level = np.polyfit(size, spent, 1) if np.ptp(size) > 0 else (0.0, float(spent.mean()))
    excess = dict(zip(known, np.exp(spent - slope * size - level), strict=True))
    lines = [f"time: predicted {np.exp(level):.3g} ms * pieces^{slope:.2f}", f"{'over':>8s} {'ms':>9s} {'pieces':>7s}  name"]
    for name in sorted(known, key=lambda n: -excess[n])[:count]:
        lines.append(f"{excess[name]:8.1f} {known[name].ms:9.1f} {known[name].pieces:7d}  {name}")
    lines += ["memory:", f"{'MB':>8s} {'pieces':>7s}  name"]
    for name in sorted(known, key=lambda n: -known[n].mb)[:count]:
        lines.append(f"{known[name].mb:8.1f} {known[name].pieces:7d}  {name}")
    return "\n".join(lines)


def failed(outcomes: Outcomes) -> bool:
    """True when anything happened that must not."""
    return any(o.category in BAD for o in outcomes.values())
