"""Figures and promises, and the table of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass
class Report:
    """What was measured, and what of it had been promised.

    Attributes
    ----------
    figures : list of (str, str, str)
        Part, name, value.
    promises : list of (str, str, bool)
        Part, what was promised and the figure, whether it was kept.
    """

    figures: list[tuple[str, str, str]] = field(default_factory=list)
    promises: list[tuple[str, str, bool]] = field(default_factory=list)

    def figure(self, part: str, name: str, value: str) -> None:
        """Note a figure."""
        self.figures.append((part, name, value))

    def times(self, part: str, name: str, seconds: Sequence[float]) -> None:
        """Note how long something took, often."""
        marks = " / ".join(f"{1000 * quantile(seconds, q):.1f}" for q in (0.5, 0.95, 0.99, 1.0))
        self.figure(part, name, f"{marks} ms (p50 / p95 / p99 / longest of {len(seconds)})")

    def promise(self, part: str, text: str, kept: bool) -> None:
        """Note a promise."""
        self.promises.append((part, text, bool(kept)))

    @property
    def broken(self) -> list[str]:
        """The promises that were not kept."""
        return [f"{part}: {text}" for part, text, kept in self.promises if not kept]

    def table(self) -> str:
        """Everything, a line each."""
        lines = [f"{part:<10} {name:<34} {value}" for part, name, value in self.figures]
        lines += [f"{part:<10} {'kept  ' if kept else 'BROKEN'} {text}" for part, text, kept in self.promises]
        return "\n".join(sorted(lines, key=lambda line: self._parts().index(line.split()[0])))

    def _parts(self) -> list[str]:
        return list(dict.fromkeys([part for part, *_ in self.figures] + [part for part, *_ in self.promises]))


def quantile(values: Sequence[float], q: float) -> float:
    """The smallest value that is not below a share q of all; not a number where there is none."""
    if not values:
        return float("nan")
    ordered = sorted(values)
    return ordered[max(0, math.ceil(q * len(ordered)) - 1)]
