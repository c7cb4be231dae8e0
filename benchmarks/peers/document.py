"""docs/performance.md and its pictures, from one run; the lines that a run prints.

What stands between the two markers of the document is written anew, everything else in it is left as it is.
"""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks import fonts, resources
from benchmarks.growth import LIMIT, Family, header, table
from benchmarks.peers import pictures
from benchmarks.peers.aims import BOOST, number, reached, reached_by_processes
from benchmarks.peers.cases import EVERYONE
from benchmarks.peers.environment import ROOT
from benchmarks.peers.results import Results
from benchmarks.peers.solve import RIGHT, Row
from benchmarks.stages import stages_of

DOCUMENT = ROOT / "docs" / "performance.md"
PICTURES = ROOT / "docs" / "performance"
BEGIN, END = "<!-- measured -->", "<!-- end of measured -->"
Table = list[str]


def line(row: Row) -> str:
    """A row of the run as it is printed."""
    own = row.ours
    text = f"{row.group:15s} {row.name:28s} {row.tolerance:<6g} {row.edges:6d} edges  "
    if own.ms is None:
        return text + own.failed
    text += f"{own.ms:9.3f} ms (dict {row.to_dict_ms:.3f}, json {row.to_json_ms:.3f}), {own.kept} segments"
    for peer in row.peers:
        text += f" | {peer.who} {_ratio(row, peer.who)} kept {peer.kept}"
    return text


def write(results: Results) -> None:
    """The document and its pictures."""
    rows, families = results.rows, results.families
    PICTURES.mkdir(parents=True, exist_ok=True)
    pictures.ratios(rows, PICTURES / "ratios.svg")
    pictures.growth(families, PICTURES / "growth.svg")
    parts = [
        _conditions(results),
        ["## Aims", "", *_aims(results)],
        ["## Times of others, in times of ours", "", "![ratios](performance/ratios.svg)", "", *_ratios(rows)],
        ["## Right or wrong", "", *_outcomes(rows), "", *_distances(rows)],
        ["## Times of ours, and what is not counted in them", "", *_times(rows)],
        ["## Glyphs of whole fonts", "", *fonts.table(results.fonts)],
        ["## Memory, and the first use", "", *resources.tables(results.memories, results.first)],
        ["## Growth", "", "![growth](performance/growth.svg)", "", *_growth(families)],
        ["## Where the time goes", "", *_profiles(results), "", *_longest(results.profiles)],
    ]
    measured = "\n\n".join("\n".join(part) for part in parts)
    old = DOCUMENT.read_text(encoding="utf-8")
    before, rest = old.split(BEGIN)
    DOCUMENT.write_text(f"{before}{BEGIN}\n{measured}\n{END}{rest.split(END)[1]}", encoding="utf-8")


# Parts ---------------------------------------------------------------------------------------------------------------
def _conditions(results: Results) -> Table:
    lines = ["## The run", "", "One run on one shared machine, one thread each. Others kept it busy meanwhile: load"]
    lines.append(f"{results.load:.1f} over the last quarter of an hour, on {results.processors} processors.")
    lines += ["", "Peers: " + ", ".join(f"{name} {version}" for name, version in results.peers.items()) + "."]
    lines += [f"Not installed: {name} ({reason})." for name, reason in results.missing.items()]
    return lines + [f"Left out for want of time: {name}." for name in results.left_out]


def _aims(results: Results) -> Table:
    said = {True: "met", False: "**not met**", None: "no figure"}
    found = reached(results.rows, results.families) + reached_by_processes(results.fonts, results.memories, results.first)
    lines = ["| aim | reached | |", "|---|---|---|"]
    return lines + [f"| {r.aim} | {r.figure} | {said[r.met]} |" for r in found]


def _ratios(rows: Sequence[Row]) -> Table:
    lines = [f"| shape | tolerance | edges | segments of ours | {' | '.join(EVERYONE)} |"]
    lines.append("|---|---:|---:|---:|" + "---:|" * len(EVERYONE))
    for row in rows:
        cells = " | ".join(_ratio(row, who) for who in EVERYONE)
        lines.append(f"| {row.name} | {row.tolerance:g} | {row.edges:,} | {row.ours.kept or 0:,} | {cells} |")
    return lines


def _ratio(row: Row, who: str) -> str:
    answer = next((p for p in row.peers if p.who == who), None)
    if answer is None:
        return ""
    ratio = row.ratio(who)
    return answer.failed.split(",")[0] if ratio is None else f"{number(ratio)}{' (not finite)' if answer.failed else ''}"


def _outcomes(rows: Sequence[Row]) -> Table:
    """How each program fared on the shapes whose distances were measured."""
    judged = [row for row in rows if row.ours.stray is not None or row.closed_form is not None]
    lines = [f"| program | shapes | crash | error | over time | not finite | off by more than {RIGHT:g} |", "|---|" + "---:|" * 6]
    for who in ("mat-core", *EVERYONE):
        answers = [a for row in judged for a in (row.ours, *row.peers) if a.who == who]
        if all(a.stray is None and not a.failed for a in answers):
            continue  # wrote no lines: pyvoronoi's diagram is that of Boost.Polygon
        counted = [sum(a.failed.startswith(how) for a in answers) for how in ("crash", "error", "over", "points")]
        wrong = sum(not a.failed and a.wrong for a in answers)
        lines.append(f"| {who} | {len(answers)} | {' | '.join(map(str, [*counted, wrong]))} |")
    return lines


def _distances(rows: Sequence[Row]) -> Table:
    lines = ["| shape | tolerance | program | kept | strays by | misses by |", "|---|---:|---|---:|---:|---:|"]
    for row in rows:
        for answer in (row.ours, *row.peers):
            if answer.stray is None or row.group in ("glyphs", "icons"):
                continue
            kept = f"{answer.kept or 0:,}"
            lines.append(f"| {row.name} | {row.tolerance:g} | {answer.who} | {kept} | {answer.stray:.1e} | {answer.missed:.1e} |")
    known = [row.closed_form for row in rows if row.closed_form is not None]
    if known:
        lines += ["", f"Where the axis is known in closed form ({len(known)} rows), the axis that all are held against is within"]
        lines.append(f"{max(known):.1e} of it.")
    return lines


def _times(rows: Sequence[Row]) -> Table:
    lines = ["| shape | tolerance | `medial_axis`, ms | `Domain.from_dict` | `to_dict` | `to_json` |", "|---|" + "---:|" * 5]
    for row in rows:
        cells = [row.ours.ms, row.from_dict_ms, row.to_dict_ms, row.to_json_ms]
        text = " | ".join("" if v is None else number(v) for v in cells)
        lines.append(f"| {row.name} | {row.tolerance:g} | {text} |")
    return lines


def _growth(families: Sequence[Family]) -> Table:
    lines = [*header()]
    for family in families:
        lines += table(family) if family.figures else []
    ended = [f"{f.name}: {f.ended}." for f in families if f.ended]
    climbed = [
        f"{f.name}, {n:,} edges: {r:.0f} settings of the tolerances were tried before one passed its certificate."
        for f in families
        for n, r in zip(f.sizes, f.rungs(), strict=True)
        if r > 1
    ]
    lines += ["", f"Milliseconds; a family is left off after a size that takes more than {LIMIT:g} s in all."]
    return lines + ended + climbed


def _profiles(results: Results) -> Table:
    """Per shape the stages as shares, what would remain without the longest one, and how Boost.Polygon compares to that."""
    names = list(dict.fromkeys(name for figures in results.profiles.values() for name in stages_of(figures)))
    lines = [f"| shape | ms | {' | '.join(names)} | without the longest, ms | Boost.Polygon / that |"]
    lines.append("|---|---:|" + "---:|" * (len(names) + 2))
    boost = {f"{row.name} {row.tolerance:g}": p.ms for row in results.rows for p in row.peers if p.who == BOOST and p.ms}
    for label, figures in results.profiles.items():
        whole, parts = figures["medial_axis"], stages_of(figures)
        shares = " | ".join(f"{100 * parts.get(name, 0.0) / whole:.0f} %" for name in names)
        rest = whole - max(parts.values())
        ratio = number(boost[label] / rest) if label in boost else ""
        lines.append(f"| {label} | {number(whole)} | {shares} | {number(rest)} | {ratio} |")
    return lines


def _longest(profiles: dict[str, dict[str, float]]) -> Table:
    """Which stages take most, and where."""
    of: dict[str, list[str]] = {}
    for label, figures in profiles.items():
        parts = stages_of(figures)
        of.setdefault(max(parts, key=lambda name: parts[name]), []).append(label)
    return [f"Longest stage: {'; '.join(f'{name} on {len(labels)} of {len(profiles)}' for name, labels in of.items())}."]
