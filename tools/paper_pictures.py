"""Pictures of a march: the boundary, the points that were traced, and the chords to their footpoints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core import Domain, MatError
from mat_core.boundary.sites import SiteTable, build_sites
from mat_core.formats.svg import outline_path
from mat_core.formats.svg_paths import Frame
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import VERTEX_LEAF
from mat_core.tolerances import LADDER
from mat_core.tracing.march import DEFAULT_CHECK_STEP, default_step
from mat_core.tracing.march.footpoint import AxisPoint, axis_point, corresponding_footpoint
from mat_core.tracing.march.record import Strip
from mat_core.tracing.march.step import parameter_step
from mat_core.tracing.march.walk import March

Floats = NDArray[np.float64]

WIDTH = 420
SMOOTH_ANGLE = 1e-6
CLOSEST = 0.004  # points of a drawn trace, relative to the size: of finer ones only so many are drawn
CHORDS = 0.03  # between drawn pairs of footpoints, relative to the size

_STYLE = """
.fill{fill:#f3f1ea;fill-rule:evenodd}
.boundary{fill:none;stroke:#33343a;stroke-width:1.2;stroke-linejoin:round}
.chord{fill:none;stroke:#3a78b4;stroke-opacity:.4;stroke-width:.6}
.trace{fill:none;stroke:#c2185b;stroke-width:1.4;stroke-linejoin:round}
.point{fill:#c2185b}
.lost{fill:none;stroke:#e0502a;stroke-width:2}
"""


class Trace(NamedTuple):
    """A march and what it left behind.

    points, feet: of every strip, (n, 2) and (n, 2, 2), in the caller's coordinates; steps: tracing steps taken; corners: convex
    vertices met; error: what ended it early.
    """

    points: list[Floats]
    feet: list[Floats]
    steps: int
    corners: int
    error: MatError | None


def march_of(domain: Domain, step: float | None = None, check_step: int | None = None) -> Trace:
    """Run a march by itself, also where it is lost, and compute the points of its strips anew."""
    table = build_sites(domain, SMOOTH_ANGLE, LADDER[0])
    size = domain.size * table.scale
    length = default_step(table, size) if step is None else step * size
    walk = March(table, length, check_step or DEFAULT_CHECK_STEP)
    error: MatError | None = None
    try:
        walk.run()
    except MatError as caught:
        error = caught
    points, feet = [], []
    for strip in walk.record.strips:
        traced = _points_of(walk, strip, length)
        points.append(_to_input(table, np.array([(p.x, p.y) for p in traced])))
        both = [(_foot(table, strip.a, p.right), _foot(table, strip.b, p.left)) for p in traced]
        feet.append(_to_input(table, np.array(both).reshape(-1, 2)).reshape(-1, 2, 2))
    corners = sum(disc.kind == VERTEX_LEAF for disc in walk.record.discs)
    return Trace(points, feet, walk.steps, corners, error)


def _points_of(walk: March, strip: Strip, length: float) -> list[AxisPoint]:
    """The points traced on a strip: its two discs, and in between the right footpoints one step apart."""
    t = walk.record.table
    du = parameter_step(walk.record, strip.a, length)
    first, last = walk.record.discs[strip.disc0], walk.record.discs[strip.disc1]
    traced = [AxisPoint(first.x, first.y, first.r, strip.a0, strip.b0)]
    for right in np.arange(strip.a0 + du, strip.a1, du).tolist():
        left = corresponding_footpoint(t, strip.a, right, strip.b, traced[-1].left, strip.b1, 0.0)
        point = None if left is None else axis_point(t, strip.a, right, strip.b, left)
        if point is None:
            break
        traced.append(point)
    return [*traced, AxisPoint(last.x, last.y, last.r, strip.a1, strip.b1)]


def _foot(t: SiteTable, site: int, s: float) -> tuple[float, float]:
    x, y, *_ = evaluate(t.si, t.sf, t.cp, site, s, 0.0, 0.0)
    return float(x), float(y)


def _to_input(t: SiteTable, points: Floats) -> Floats:
    return points / t.scale + t.origin


def picture(domain: Domain, trace: Trace, dots: bool = False) -> str:
    """The march as an SVG document; with `dots` every traced point."""
    frame = Frame(domain.bbox, WIDTH)

    def path(points: Floats) -> str:
        return "M" + " ".join(f"{x:.1f},{y:.1f}" for x, y in frame.points(points).tolist())

    outline = outline_path(domain, frame)
    body = [f'<path class="fill" d="{outline}"/>']
    for points, feet in zip(trace.points, trace.feet, strict=True):
        for k in _spread(points, CHORDS * domain.size)[1:-1]:
            body.append(f'<path class="chord" d="{path(np.array([feet[k][0], points[k], feet[k][1]]))}"/>')
    for points in trace.points:
        kept = points if dots else points[_spread(points, CLOSEST * domain.size)]
        body.append(f'<path class="trace" d="{path(kept)}"/>')
        if dots:
            places = (place.split(",") for place in path(kept)[1:].split(" "))
            body += [f'<circle class="point" cx="{x}" cy="{y}" r="2"/>' for x, y in places]
    body.append(f'<path class="boundary" d="{outline}"/>')
    place = getattr(trace.error, "place", None)
    if place is not None:
        x, y = path(np.array([place]))[1:].split(",")
        body.append(f'<circle class="lost" cx="{x}" cy="{y}" r="9"/>')
    w, h = f"{frame.width:.0f}", f"{frame.height:.0f}"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}">'
    return "\n".join([head, f"<style>{_STYLE}</style>", *body, "</svg>"]) + "\n"


def _spread(points: Floats, apart: float) -> list[int]:
    """Rows of a polyline no nearer to each other than `apart` along it, with both ends."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    kept = [0]
    for k in range(1, len(points) - 1):
        if along[k] - along[kept[-1]] >= apart:
            kept.append(k)
    return [*kept, len(points) - 1]
