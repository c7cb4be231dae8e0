"""A picture of a domain and its medial axis, as one SVG file that needs nothing else.

From back to front: the domain filled lightly, some maximal discs, the axis coloured by its radius, the boundary, the
nodes by kind. The y axis points up. Curves are curves (`mat_core.formats.svg_paths`); strokes and dots grow thinner where
the domain itself is thin.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from mat_core.formats.primitives import primitives, rounding
from mat_core.formats.svg_paths import Frame, hermite, hull_box, numbers, path_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mat_core.axis import MedialAxis
    from mat_core.model.curve import RationalBSpline
    from mat_core.model.domain import Domain

Floats = NDArray[np.float64]

COLOURS = 24  # steps of the radius scale
STEP_PIXELS = 12.0  # length of the cubics that make up the axis, each of one colour
MOST_STEPS = 48  # of them in one piece
DISCS = 12  # shown at most
SMALLEST_DISC = 0.2  # of the largest one shown
DISC_PIXELS = 4.0  # radius below which a disc is not worth showing
APART = 0.85  # of the sum of their radii: how far apart the discs shown are
MEETS = 1e-9  # of the size: ends as near as this are one
THIN_PIXELS = 12.0  # largest radius below which strokes and dots grow thinner in proportion
THINNEST = 0.4

# from small to large radius; perceptually even, legible on the fill and for the colour-blind
_ANCHORS = np.array([[247, 127, 79], [222, 73, 104], [150, 44, 128], [81, 36, 124], [20, 30, 85]], dtype=float)

_STYLE = """
.fill{{fill:#f3f1ea;fill-rule:evenodd;stroke:none}}
.boundary{{fill:none;stroke:#33343a;stroke-width:{boundary:.3g};stroke-linejoin:round;stroke-linecap:round}}
.disc{{fill:#3a78b4;fill-opacity:.06;stroke:#3a78b4;stroke-opacity:.45;stroke-width:{disc:.3g}}}
.axis{{fill:none;stroke-width:{axis:.3g};stroke-linejoin:round;stroke-linecap:round}}
.result{{fill:#3a78b4;fill-opacity:.08;fill-rule:evenodd;stroke:#3a78b4;stroke-width:{result:.3g};stroke-linejoin:round}}
.line{{fill:none}}
.node{{stroke:#fff;stroke-width:{disc:.3g}}}
.branch,.point{{fill:#1d2a5b}}.convex_vertex{{fill:#f0793f}}.curvature_center{{fill:#c2185b}}.arc_center{{fill:#2a8c6c}}
"""
_STROKES = {"boundary": 1.4, "disc": 0.8, "axis": 2.0, "result": 1.4}  # pixels, where the domain is not thin


def render(axis: MedialAxis, width: int = 800) -> str:
    """Draw the axis in its domain.

    Parameters
    ----------
    axis : MedialAxis
    width : int
        Of the picture's larger side, in pixels.

    Returns
    -------
    str
        An SVG document.
    """
    frame = Frame(axis.domain.bbox, width)
    outline = outline_path(axis.domain, frame)
    thin = _thinness(axis, frame)
    title = f"Medial axis: {len(axis.nodes)} nodes, {len(axis.segments)} segments, {axis.runs.cycles} cycles"
    return _document(
        frame,
        title,
        thin,
        [
            f'<path class="fill" d="{outline}"/>',
            *_discs(axis, frame),
            *axis_strokes(axis, frame),
            f'<path class="boundary" d="{outline}"/>',
            *_nodes(axis, frame, thin),
        ],
    )


def render_result(
    axis: MedialAxis,
    paths: Sequence[Iterable[RationalBSpline]],
    name: str = "offset",
    width: int = 800,
    *,
    fill: bool = True,
) -> str:
    """Draw curves that were found from an axis, such as the loops of an offset, with the boundary of the domain.

    Parameters
    ----------
    axis : MedialAxis
    paths : sequence of iterables of RationalBSpline
        Each head to tail, closed or open; they may leave the domain.
    name : str
        What they are.
    width : int
        Of the picture's larger side, in pixels.
    fill : bool
        Whether closed paths bound regions, which are then filled lightly.

    Returns
    -------
    str
        An SVG document.
    """
    drawn = [curves for path in paths if (curves := list(path))]
    frame = Frame(hull_box((curve for curves in drawn for curve in curves), axis.domain.bbox), width)
    outline = outline_path(axis.domain, frame)
    tolerance = rounding(axis.domain)
    sorted_paths: dict[str, str] = {"result": "", "result line": ""}
    for curves in drawn:
        closed = is_closed(curves, axis.domain.size)
        if shapes := primitives(curves, tolerance):
            sorted_paths["result" if closed and fill else "result line"] += path_of(shapes, frame, closed)
    return _document(
        frame,
        f"{name}: {len(drawn)} {'path' if len(drawn) == 1 else 'paths'}",
        _thinness(axis, frame),
        [
            f'<path class="fill" d="{outline}"/>',
            *(f'<path class="{kind}" d="{path}"/>' for kind, path in sorted_paths.items() if path),
            f'<path class="boundary" d="{outline}"/>',
        ],
    )


def _document(frame: Frame, title: str, thin: float, parts: list[str]) -> str:
    w, h = f"{frame.width:.6g}", f"{frame.height:.6g}"
    style = _STYLE.format(**{name: thin * stroke for name, stroke in _STROKES.items()})
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" role="img">'
    return "\n".join([head, f"<title>{escape(title)}</title>", f"<style>{style}</style>", *parts, "</svg>"]) + "\n"


def outline_path(domain: Domain, frame: Frame) -> str:
    """All loops of the domain as one path."""
    tolerance = rounding(domain)
    return "".join(path_of(primitives(loop, tolerance), frame) for loop in (domain.outer, *domain.holes))


def is_closed(curves: list[RationalBSpline], size: float) -> bool:
    """Whether a path ends where it starts."""
    gap = curves[-1].control_points[-1] - curves[0].control_points[0]
    return bool(np.hypot(*gap) <= MEETS * size)


def _thinness(axis: MedialAxis, frame: Frame) -> float:
    """The factor of strokes and dots: 1, but less where the largest disc is but a few pixels."""
    largest = max((node.radius for node in axis.nodes), default=0.0)
    largest = max(largest, float(axis.control_discs[:, 2].max(initial=0.0)))
    return float(np.clip(largest * frame.scale / THIN_PIXELS, THINNEST, 1.0))


def colour_scale(count: int = COLOURS) -> list[str]:
    """The scale as hexadecimal colours, small radius first."""
    at = np.linspace(0.0, len(_ANCHORS) - 1.0, count)
    channels = [np.interp(at, np.arange(len(_ANCHORS)), _ANCHORS[:, c]) for c in range(3)]
    return [f"#{int(r):02x}{int(g):02x}{int(b):02x}" for r, g, b in zip(*channels, strict=True)]


def axis_strokes(axis: MedialAxis, frame: Frame) -> list[str]:
    """The axis, one path for each colour of the scale."""
    c = axis.curves
    if not len(c.part_f):
        return []
    piece, t0, t1 = _steps(axis, frame)
    segment = c.part_segment[piece]
    starts, ends = axis.evaluate(segment, t0), axis.evaluate(segment, t1)
    width = (t1 - t0)[:, None]
    cubics = hermite(
        frame.points(starts[:, :2]),
        frame.points(ends[:, :2]),
        frame.vectors(width * starts[:, 3:5]),
        frame.vectors(width * ends[:, 3:5]),
    )
    middle = 0.5 * (starts[:, 2] + ends[:, 2])
    largest = max(float(middle.max()), 1e-300)
    level = np.minimum((COLOURS * middle / largest).astype(int), COLOURS - 1)
    straight = (c.part_i[piece, 3] == 0).tolist()
    fresh = np.append(True, (np.diff(segment) != 0) | (np.diff(level) != 0))
    runs_on = np.append((np.diff(piece) == 0) & ~fresh[1:], False).tolist()
    paths: list[list[str]] = [[] for _ in range(COLOURS)]
    for cubic, own, begins, goes_on, is_line in zip(cubics, level.tolist(), fresh.tolist(), runs_on, straight, strict=True):
        if begins:
            paths[own].append(f"M{numbers(cubic[0])}")
        if not is_line:
            paths[own].append(f"C{numbers(cubic[1:])}")
        elif not goes_on:
            paths[own].append(f"L{numbers(cubic[3])}")
    shades = zip(colour_scale(), paths, np.arange(COLOURS) * largest / COLOURS, strict=True)
    return [
        f'<path class="axis" stroke="{colour}" d="{"".join(path)}"><title>radius from {low:.4g}</title></path>'
        for colour, path, low in shades
        if path
    ]


def _steps(axis: MedialAxis, frame: Frame) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Pieces of the axis cut into steps of a few pixels: the piece, t at the start, t at the end."""
    c = axis.curves
    t0, t1 = c.part_t[:, 0], c.part_t[:, 1]
    at = np.stack((t0, 0.5 * (t0 + t1), t1))
    places = [axis.evaluate(c.part_segment, np.ascontiguousarray(row))[:, :2] for row in at]
    pixels = frame.scale * sum(np.hypot(*(b - a).T) for a, b in pairwise(places))
    count = np.clip(np.ceil(pixels / STEP_PIXELS), 1, MOST_STEPS).astype(np.int64)
    piece = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count)
    shares = (t1 - t0)[piece] / count[piece]
    return piece, t0[piece] + number * shares, t0[piece] + (number + 1) * shares


def _discs(axis: MedialAxis, frame: Frame) -> list[str]:
    """The largest discs at nodes and in the middle of segments, those that crowd others left out."""
    ids = np.arange(len(axis.curves.degree))
    middles = axis.evaluate(ids, np.full(len(ids), 0.5))[:, :3]
    candidates = np.vstack((axis.node_discs, middles))
    shown: list[list[float]] = []
    for x, y, r in candidates[np.argsort(-candidates[:, 2], kind="stable")].tolist():
        if len(shown) == DISCS or r * frame.scale < DISC_PIXELS or (shown and r < SMALLEST_DISC * shown[0][2]):
            break
        if all(np.hypot(x - a, y - b) >= APART * (r + q) for a, b, q in shown):
            shown.append([x, y, r])
    return [_circle("disc", np.array([x, y]), r * frame.scale, frame) for x, y, r in shown]


def _nodes(axis: MedialAxis, frame: Frame, thin: float) -> list[str]:
    """A dot for every node, with its kind and radius as a tooltip."""
    size = thin * (3.4 if len(axis.nodes) < 200 else 2.0)
    out = []
    for n in axis.nodes:
        tip = f"<title>node {n.id}: {n.kind}, radius {n.radius:.6g}</title>"
        pixels = size if n.kind in ("branch", "point") else 0.8 * size
        out.append(_circle(f"node {n.kind}", np.array(n.point), pixels, frame, tip))
    return out


def _circle(name: str, centre: Floats, pixels: float, frame: Frame, inside: str = "") -> str:
    x, y = frame.points(centre).tolist()
    start = f'<circle class="{name}" cx="{x:.2f}" cy="{y:.2f}" r="{pixels:.2f}"'
    return f"{start}>{inside}</circle>" if inside else f"{start}/>"
