"""A picture of a domain and its medial axis, as one SVG file that needs nothing else.

From back to front: the domain filled lightly, some maximal discs, the axis coloured by its radius, the boundary, the
nodes by kind. The y axis points up. Boundary curves that SVG can draw (lines, polynomial quadratics and cubics) are
true curves, others fine polylines.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis
    from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

MARGIN = 16.0  # pixels around the domain
COLOURS = 24  # steps of the radius scale
STEPS = 10  # chords drawn for one piece of the axis
BOUNDARY_STEPS = 24  # chords drawn for one boundary piece that SVG has no curve for
DISCS = 6  # largest branch discs shown

# from small to large radius; perceptually even, legible on the fill and for the colour-blind
_ANCHORS = np.array([[247, 127, 79], [222, 73, 104], [150, 44, 128], [81, 36, 124], [20, 30, 85]], dtype=float)

_STYLE = """
.fill{fill:#f3f1ea;fill-rule:evenodd;stroke:none}
.boundary{fill:none;stroke:#33343a;stroke-width:1.4;stroke-linejoin:round;stroke-linecap:round}
.disc{fill:#3a78b4;fill-opacity:.06;stroke:#3a78b4;stroke-opacity:.45;stroke-width:.8}
.axis{fill:none;stroke-width:2;stroke-linejoin:round;stroke-linecap:round}
.node{stroke:#fff;stroke-width:.8}
.branch,.point{fill:#1d2a5b}.convex_vertex{fill:#f0793f}.curvature_center{fill:#c2185b}.arc_center{fill:#2a8c6c}
"""


class _Frame:
    """The map from the caller's coordinates to pixels, y upwards."""

    def __init__(self, bbox: tuple[float, float, float, float], width: int) -> None:
        xmin, ymin, xmax, ymax = bbox
        inner = max(width - 2 * MARGIN, 1.0)
        self.scale = inner / max(xmax - xmin, ymax - ymin)
        self.left, self.top = xmin, ymax
        self.width = (xmax - xmin) * self.scale + 2 * MARGIN
        self.height = (ymax - ymin) * self.scale + 2 * MARGIN

    def points(self, points: Floats) -> Floats:
        """(n, 2) pixels."""
        out = np.empty((len(points), 2))
        out[:, 0] = (points[:, 0] - self.left) * self.scale + MARGIN
        out[:, 1] = (self.top - points[:, 1]) * self.scale + MARGIN
        return out


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
    frame = _Frame(axis.domain.bbox, width)
    outline = "".join(_loop(loop, frame) for loop in (axis.domain.outer, *axis.domain.holes))
    w, h = f"{frame.width:.6g}", f"{frame.height:.6g}"
    title = f"Medial axis: {len(axis.nodes)} nodes, {len(axis.segments)} segments, {axis.runs.cycles} cycles"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" role="img">',
        f"<title>{escape(title)}</title>",
        f"<style>{_STYLE}</style>",
        f'<path class="fill" d="{outline}"/>',
        *_discs(axis, frame),
        *_strokes(axis, frame),
        f'<path class="boundary" d="{outline}"/>',
        *_nodes(axis, frame),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _numbers(points: Floats) -> str:
    """Pixels to a hundredth, separated by blanks."""
    return " ".join(f"{v:.2f}".rstrip("0").rstrip(".") for v in points.reshape(-1).tolist())


def _loop(edges: tuple[RationalBSpline, ...], frame: _Frame) -> str:
    """One closed sub-path."""
    start = edges[0].control_points[:1]
    return "M" + _numbers(frame.points(start)) + "".join(_edge(edge, frame) for edge in edges) + "Z"


def _edge(edge: RationalBSpline, frame: _Frame) -> str:
    """Path commands for one edge, from its start."""
    rows, breaks = edge.pieces()
    step = edge.degree + 1
    spans = [rows[i : i + step, :2] for i in range(0, len(rows), step)]
    command = {1: "L", 2: "Q", 3: "C"}.get(edge.degree)
    if command and (edge.degree == 1 or not edge.is_rational):
        return "".join(command + _numbers(frame.points(span[1:])) for span in spans)
    shares = np.arange(1, BOUNDARY_STEPS + 1) / BOUNDARY_STEPS
    u = (breaks[:-1, None] + shares * np.diff(breaks)[:, None]).reshape(-1)
    return "L" + _numbers(frame.points(edge.evaluate(u)))


def _colours() -> list[str]:
    """The scale as hexadecimal colours, small radius first."""
    at = np.linspace(0.0, len(_ANCHORS) - 1.0, COLOURS)
    channels = [np.interp(at, np.arange(len(_ANCHORS)), _ANCHORS[:, c]) for c in range(3)]
    return [f"#{int(r):02x}{int(g):02x}{int(b):02x}" for r, g, b in zip(*channels, strict=True)]


def _strokes(axis: MedialAxis, frame: _Frame) -> list[str]:
    """The axis, one path for each colour of the scale."""
    c = axis.curves
    pieces = len(c.part_f)
    if not pieces:
        return []
    shares = np.arange(STEPS + 1) / STEPS
    t = c.part_t[:, :1] + shares * (c.part_t[:, 1:] - c.part_t[:, :1])
    discs = axis.evaluate(np.repeat(c.part_segment, STEPS + 1), t.reshape(-1))[:, :3]
    pixels = frame.points(discs[:, :2]).reshape(pieces, STEPS + 1, 2)
    radius = discs[:, 2].reshape(pieces, STEPS + 1)
    middle = 0.5 * (radius[:, 1:] + radius[:, :-1])
    level = np.minimum((COLOURS * middle / max(float(middle.max()), 1e-300)).astype(int), COLOURS - 1)
    paths: list[list[str]] = [[] for _ in range(COLOURS)]
    for piece in range(pieces):
        first = 0
        for step in range(1, STEPS + 1):
            if step < STEPS and level[piece, step] == level[piece, first]:
                continue
            chords = pixels[piece, first : step + 1]
            paths[level[piece, first]].append(f"M{_numbers(chords[:1])}L{_numbers(chords[1:])}")
            first = step
    return [
        f'<path class="axis" stroke="{colour}" d="{"".join(path)}"/>'
        for colour, path in zip(_colours(), paths, strict=True)
        if path
    ]


def _discs(axis: MedialAxis, frame: _Frame) -> list[str]:
    """The largest discs of branch points and of the rest, those inside others left out."""
    order = sorted(axis.nodes, key=lambda n: (n.kind not in ("branch", "point"), -n.radius))
    shown: list[tuple[float, float, float]] = []
    for node in order:
        (x, y), r = node.point, node.radius
        near = any(np.hypot(x - a, y - b) < 0.6 * max(r, q) for a, b, q in shown)
        if len(shown) == DISCS or near or r * frame.scale < 4.0:
            continue
        shown.append((x, y, r))
    return [_circle("disc", np.array([x, y]), r * frame.scale, frame) for x, y, r in shown]


def _nodes(axis: MedialAxis, frame: _Frame) -> list[str]:
    """A dot for every node, with its kind and radius as a tooltip."""
    size = 3.4 if len(axis.nodes) < 200 else 2.0
    out = []
    for n in axis.nodes:
        tip = f"<title>node {n.id}: {n.kind}, radius {n.radius:.6g}</title>"
        pixels = size if n.kind in ("branch", "point") else 0.8 * size
        out.append(_circle(f"node {n.kind}", np.array(n.point), pixels, frame, tip))
    return out


def _circle(name: str, centre: Floats, pixels: float, frame: _Frame, inside: str = "") -> str:
    x, y = frame.points(centre[None])[0]
    start = f'<circle class="{name}" cx="{x:.2f}" cy="{y:.2f}" r="{pixels:.2f}"'
    return f"{start}>{inside}</circle>" if inside else f"{start}/>"
