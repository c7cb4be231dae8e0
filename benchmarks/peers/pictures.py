"""Two pictures of a run: times of peers in times of ours, and growth of time with the number of edges."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

from benchmarks.growth import Family
from benchmarks.peers.cases import EVERYONE
from benchmarks.peers.solve import Row

STYLE = {"svg.fonttype": "none", "svg.hashsalt": "mat", "font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False}
COLORS = ("#1f4e9c", "#5aa0d8", "#c0392b", "#e08e0b", "#7f8c8d")
MARKERS = ("o", "v", "s", "D", "^")


def ratios(rows: Sequence[Row], path: Path) -> None:
    """A line a shape, a mark a peer (hollow where its axis is wrong), on a logarithmic scale; right of 1 ours is faster."""
    shown = [row for row in rows if row.peers and row.ours.ms]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(8.0, 1.0 + 0.17 * len(shown)))
        for who, color, marker in zip(EVERYONE, COLORS, MARKERS, strict=True):
            axes.scatter([], [], s=22, c=color, marker=marker, label=who)
            for wrong in (False, True):
                places = [
                    (ratio, y)
                    for y, row in enumerate(shown)
                    for answer in row.peers
                    if answer.who == who and answer.wrong == wrong and (ratio := row.ratio(who)) is not None
                ]
                if places:
                    filling = "none" if wrong else color
                    axes.scatter(*zip(*places, strict=True), s=22, facecolors=filling, edgecolors=color, marker=marker, zorder=3)
        axes.axvline(1.0, color="black", linewidth=1.0)
        axes.set_xscale("log")
        axes.set_ylim(len(shown) - 0.5, -0.5)
        axes.set_yticks(range(len(shown)), [f"{row.name}, {row.tolerance:g}" for row in shown])
        axes.grid(axis="both", color="#dddddd", linewidth=0.5)
        axes.set_xlabel("time of the peer / time of mat-core (hollow: its axis is wrong)")
        axes.legend(loc="lower right", framealpha=1.0)
        _save(figure, path)


def growth(families: Sequence[Family], path: Path) -> None:
    """Time over number of edges, both logarithmic, beside a line of exponent 1."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(7.0, 4.2))
        for family in families:
            times = [f["medial_axis"] / 1e3 for f in family.figures]
            axes.loglog(family.sizes, times, marker="o", markersize=4, label=f"{family.name}, {family.exponent():.2f}")
        first = [f.figures[0]["medial_axis"] / 1e3 / f.sizes[0] for f in families if f.figures]
        if first:
            ends = [1e3, 1e5]
            axes.loglog(ends, [n * min(first) for n in ends], color="black", linewidth=0.8, linestyle=":", label="linear")
        axes.set_xlabel("edges")
        axes.set_ylabel("seconds, certificate included")
        axes.grid(color="#dddddd", linewidth=0.5)
        axes.legend(title="family, fitted exponent", framealpha=1.0)
        _save(figure, path)


def _save(figure: plt.Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, format="svg", metadata={"Date": None}, facecolor="white")
    plt.close(figure)
