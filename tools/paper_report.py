"""Writes docs/paper.md and its pictures: the paper's procedure run on shapes after its figures, beside the discs-first method.

Every statement about the paper that the report makes is checked by a run first; the command stops where one no longer holds.
"""

from __future__ import annotations

import gzip
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import mat_core  # noqa: E402
from mat_core import Domain, MedialAxis, NotCertified, UnsupportedOption, medial_axis  # noqa: E402
from tests.families import CATALOGUE, ellipse  # noqa: E402
from tests.paper_shapes import PAPER_SHAPES, object_2, pocket, small_hole, twice  # noqa: E402
from tools.paper_pictures import march_of, picture  # noqa: E402

Json = dict[str, Any]
TEMPLATE = ROOT / "tools" / "paper_report.md"
REPORT = ROOT / "docs" / "paper.md"
PICTURES = ROOT / "docs" / "paper"
OUTLINES = ROOT / "tests" / "corpus" / "outlines.jsonl.gz"

SAME_NODE = 1e-9  # of the size
FOOT = 0.3  # where (A4) is looked at, on a lower edge with knots from 0 to 1
SCAN = 100_001
REPEATS = 3  # of each solution
CHORDS = 32  # for the length of an edge
COARSE_STEPS = (1e-3, 1e-2, 1e-1)
PAPER_TIMES = {"14": (21, 3), "15": (9, 2), "16": (15, 1), "17": (32, 3)}  # its Table 1: segments, seconds
TITLES = {
    "12": "the example of section 5.7: reflex vertex B, smooth corner C",
    "14": "test object 1: free-form sides",
    "15": "test object 2: constrictions, sharp changes of curvature",
    "16": "test object 3: concave vertices",
    "17": "a spiral",
    "18": "a multiply connected object",
    "19": "tangential edges",
}


class Run(NamedTuple):
    """One solution or refusal, and its time in seconds."""

    axis: MedialAxis | None
    error: str
    seconds: float


def domain_of(shape: Json) -> Domain:
    """The domain of a shape of the tests."""
    return Domain.from_dict({key: shape[key] for key in ("outer", "holes") if key in shape})


def run(domain: Domain, **options: Any) -> Run:
    """Solve, or note why not; the least processor time of a few runs, which says the most on a machine that does other work."""
    return min((_once(domain, **options) for _ in range(REPEATS)), key=lambda found: found.seconds)


def _once(domain: Domain, **options: Any) -> Run:
    begun = time.process_time()
    try:
        axis = medial_axis(domain, **options)
    except (NotCertified, UnsupportedOption) as error:
        return Run(None, str(error), time.process_time() - begun)
    return Run(axis, "", time.process_time() - begun)


def agree(one: MedialAxis | None, other: MedialAxis | None) -> bool:
    """Same segments and cycles, and every node of one within 1e-9 of the size of a node of the other."""
    if one is None or other is None:
        return False
    if len(one.segments) != len(other.segments) or one.graph.cycles != other.graph.cycles or len(one.nodes) != len(other.nodes):
        return False
    apart = np.abs(one.node_discs[:, None] - other.node_discs[None]).sum(axis=2)
    return bool(max(apart.min(axis=0).max(), apart.min(axis=1).max()) <= SAME_NODE * one.domain.size)


def hold(fact: bool, statement: str) -> None:
    """Stop where the report would say what is not so."""
    if not fact:
        raise SystemExit(f"the report says what no longer holds: {statement}")


def keep(name: str, svg: str) -> str:
    """Write a picture; its Markdown."""
    (PICTURES / f"{name}.svg").write_text(svg, encoding="utf-8")
    return f"![{name}](paper/{name}.svg)"


def figures() -> str:
    """Figures 12 to 19 and Table 1."""
    rows = ["| after Fig. | segments | in the paper | tracing steps | march, s | in the paper, s | discs, ms |", "|---" * 7 + "|"]
    parts = []
    for figure, build in PAPER_SHAPES.items():
        domain = domain_of(build())
        march = run(domain, method="march")
        discs = run(domain)
        hold(agree(march.axis, discs.axis), f"march equals discs on the shape after figure {figure}: {march.error}")
        assert discs.axis is not None
        trace = march_of(domain)
        segments, seconds = PAPER_TIMES.get(figure, ("", ""))
        times = f"{march.seconds:.2f}", seconds, f"{1e3 * discs.seconds:.1f}"
        cells = figure, len(discs.axis.segments), segments, trace.steps, *times
        rows.append("| " + " | ".join(str(cell) for cell in cells) + " |")
        left = keep(f"figure-{figure}-march", picture(domain, trace))
        right = keep(f"figure-{figure}-discs", discs.axis.to_svg(420))
        parts.append(f"### After Fig. {figure}: {TITLES[figure]}\n\n| march | discs |\n|---|---|\n| {left} | {right} |\n")
    return "\n".join(parts) + "\n## Table 1\n\n" + "\n".join(rows) + "\n"


def coarse() -> str:
    """Table 2 and figures 20 and 21."""
    domain = domain_of(object_2())
    discs = run(domain)
    rows = ["| step | tracing steps | march, s | in the paper, s | result |", "|---|---|---|---|---|"]
    parts = []
    for step, seconds in zip(COARSE_STEPS, (2, 1, 1), strict=True):
        march = run(domain, method="march", step=step)
        hold(agree(march.axis, discs.axis), f"march equals discs on test object 2 with step {step}: {march.error}")
        trace = march_of(domain, step)
        rows.append(f"| {step:g} | {trace.steps} | {march.seconds:.2f} | {seconds} | equal to discs |")
        if step > COARSE_STEPS[0]:
            parts.append(keep(f"step-{step:g}", picture(domain, trace, dots=True)))
    return "\n".join(rows) + "\n\n| step 0.01, as Fig. 20 | step 0.1, as Fig. 21 |\n|---|---|\n| " + " | ".join(parts) + " |\n"


def failures() -> str:
    """One real example of each way in which the published procedure misses something."""
    corridor, corner, bay, blob = (domain_of(build()) for build in (small_hole, pocket, twice, ellipse))
    fine, wide = run(corridor, method="march"), run(corridor, method="march", step=0.02)
    hold(agree(fine.axis, run(corridor).axis), "the small hole is found by the default step")
    hold("loop 1 was never met" in wide.error, "the small hole is missed by a step of 0.02")
    pocketed = [run(corner, method="march", step=step) for step in (None, 1e-3, 1e-4)]
    hold(all("loop 1 was never met" in found.error for found in pocketed), "the hole in the pocket is missed by every step")
    hold(march_of(corner).corners == 4, "all four corners are met although a hole is not")
    solved = run(corner)
    hold(solved.axis is not None, "discs finds the hole in the pocket")
    refused = run(blob, method="march")
    hold("convex vertex" in refused.error, "an ellipse is refused")
    axis = run(bay, method="march").axis
    hold(agree(axis, run(bay).axis), "the bay is solved")
    assert axis is not None
    assert solved.axis is not None
    pair = _segments_of_pair(axis, {0, 2})
    hold(pair == 2, "the pair of edges has two segments")
    missed = keep("missed-by-steps", picture(corridor, march_of(corridor, 0.02)))
    found = keep("found-by-steps", picture(corridor, march_of(corridor)))
    in_pocket = keep("pocket-march", picture(corner, march_of(corner)))
    by_discs = keep("pocket-discs", solved.axis.to_svg(420))
    two = keep("two-segments", axis.to_svg(420))
    return f"""### Steps pass over a short branch

A corridor with a hole of radius 0.01 of the size. With a step of 0.02 the check for a branch point comes every 0.2 of the size:
the discs before and behind the hole are both empty, and the axis runs through it. The march sees only at its end that a loop was
never met:

> {wide.error}

| step 0.02 | default step |
|---|---|
| {missed} | {found} |

### Proposition 2: a hole in the pocket of a corner

The pair that leaves the right branch point for the lower right corner shares that convex vertex, so by Proposition 2 nothing is
checked on the way, and the hole in the corner's pocket is never seen, with steps of 0.001 and 0.0001 as with the default. Its
proof takes the corner's own edges for the only boundary of the region between branch point and vertex; a hole is another.
The paper's test of completeness (a topological sort lists all convex corners) passes here: all four corners are listed.

> {pocketed[0].error}

| march | discs |
|---|---|
| {in_pocket} | {by_discs} |

### No convex vertex

An ellipse, a circle, an annulus, any smooth outline: the procedure cannot start (section 4: "it is assumed that the input domain
contains atleast one convex vertex").

> {refused.error}

### Two segments for one pair

"There can be only one MAT segment for a pair of boundary segments" (proof of Proposition 2). The lower edge and the upper one, a
single B-spline with a bay, are the two sides of {pair} segments, one on either side of the branch that leads into the bay. The
paper's own Fig. 9 is another case. The march does not rely on it and gets this right.

{two}
"""


def _segments_of_pair(axis: MedialAxis, edges: set[int]) -> int:
    """Segments with footpoints on exactly these edges of the outer loop, at their middles."""
    middles = [segment.footpoints(0.5) for segment in axis.segments]
    return sum({foot.edge for foot in both} == edges and all(foot.loop == 0 for foot in both) for both in middles)


def appendix() -> str:
    """All roots of the squared equation (A4) on one edge, and what they are."""
    domain = domain_of(object_2())
    below, above = domain.outer
    u1 = FOOT * float(below.knots[-1])
    p, d1 = below.evaluate(u1), below.evaluate(u1, 1)

    def sides(u: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        d, d2 = above.evaluate(u) - p, above.evaluate(u, 1)
        across = d1[0] * d2[:, 1] - d1[1] * d2[:, 0]
        along2, along1 = (d * d2).sum(axis=1), d @ d1
        return (d1 @ d1) * along2**2 - (d2 * d2).sum(axis=1) * along1**2, along2 / across, along1 / across

    u = np.linspace(float(above.knots[0]), float(above.knots[-1]), SCAN)
    value, alpha, beta = sides(u)
    at = np.flatnonzero(value[1:] * value[:-1] < 0.0)
    wrong = int(np.count_nonzero(alpha[at] * beta[at] < 0.0))
    outside = int(np.count_nonzero((alpha[at] < 0.0) & (beta[at] < 0.0)))
    inside = len(at) - wrong - outside
    hold(wrong > 0 and len(at) > 1, "the squared equation has roots on the wrong side")
    return (
        f"For the footpoint u = {FOOT:g} on the lower edge of the shape after Fig. 15, (A4) has {len(at)} roots on the upper"
        f" edge: at {wrong} of them the two normals meet inside one edge and outside the other, at {outside} outside both, at"
        f" {inside} inside both. One of the last is the footpoint wanted. Those of the first kind are what squaring lets in; of"
        " the last kind the nearest to the previous footpoint is taken, and the two criteria decide.\n"
    )


def lengths() -> str:
    """How short segments of real outlines are."""
    checked = short = below = 0
    for shape in _outlines():
        domain = domain_of(shape)
        axis = medial_axis(domain)
        loops = (domain.outer, *domain.holes)
        edges = [edge.evaluate(np.linspace(edge.knots[0], edge.knots[-1], CHORDS + 1)) for loop in loops for edge in loop]
        shortest = min(float(np.hypot(*np.diff(points, axis=0).T).sum()) for points in edges)
        checked += len(axis.lengths)
        short += int(np.count_nonzero(axis.lengths < 0.01 * domain.size))
        below += int(np.count_nonzero(axis.lengths < shortest))
    hold(below > 0, "there are segments shorter than every edge")
    return (
        f"In the glyphs and icons above {short} of {checked} segments are shorter than 0.01 of the size, the paper's distance"
        f" between checks, and {below} are shorter than the shortest edge of their outline. The march checks at both ends of"
        " every pair of edges, too, not only every ten steps.\n"
    )


def _outlines() -> list[Json]:
    """Glyphs and icons kept for the tests."""
    with gzip.open(OUTLINES, "rt", encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


def rate() -> str:
    """How often the march succeeds on the repository's own shapes."""
    outlines = _outlines()
    groups = {
        "families of the tests": [build() for build in CATALOGUE.values()],
        "glyphs (DejaVu Sans)": [shape for shape in outlines if shape["name"].startswith("a/")],
        "icons (Material Design Icons)": [shape for shape in outlines if shape["name"].startswith("b/")],
    }
    rows = ["| shapes | number | no convex vertex | equal to discs | otherwise |", "|---|---|---|---|---|"]
    for name, shapes in groups.items():
        count: Counter[str] = Counter()
        for shape in shapes:
            domain = domain_of(shape)
            march = run(domain, method="march")
            if "convex vertex" in march.error:
                count["none"] += 1
            else:
                count["equal" if agree(march.axis, run(domain).axis) else "other"] += 1
        rows.append(f"| {name} | {len(shapes)} | {count['none']} | {count['equal']} | {count['other']} |")
    return "\n".join(rows) + "\n"


def main() -> None:
    """Write the report and its pictures."""
    mat_core.warm()
    PICTURES.mkdir(parents=True, exist_ok=True)
    for old in PICTURES.glob("*.svg"):
        old.unlink()
    text = TEMPLATE.read_text(encoding="utf-8")
    for part in (figures, coarse, failures, rate, lengths, appendix):
        text = text.replace("{" + part.__name__ + "}", part())
    REPORT.write_text(text, encoding="utf-8")
    size = sum(file.stat().st_size for file in PICTURES.glob("*.svg"))
    print(f"wrote {REPORT.relative_to(ROOT)} and {len(list(PICTURES.glob('*.svg')))} pictures of {size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
