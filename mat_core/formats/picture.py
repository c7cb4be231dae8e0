"""Pictures made of layers over a domain: regions, curves, discs, strokes of varying width, a colour field, and what they mean.

    picture = Picture(axis.domain)
    picture.lines(offset.paths, "#3a78b4", label="offset").boundary()
    picture.save("offset.svg")

Every method draws over what is there already and gives the picture back. A path is a list of curves, head to tail, that stay
curves as in `mat_core.formats.svg`, or an array (n, 2) of points with straight lines between them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mat_core.analysis.outline import measure
from mat_core.errors import UnsupportedOption
from mat_core.formats.primitives import primitives, rounding
from mat_core.formats.svg import axis_strokes, colour_scale, is_closed, outline_path
from mat_core.formats.svg_paths import MARGIN, Frame, hull_box, numbers, path_of

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis
    from mat_core.model.curve import RationalBSpline
    from mat_core.model.domain import Domain

Floats = NDArray[np.float64]
Curves = Iterable[Iterable["RationalBSpline"]]
Paths = Iterable["Iterable[RationalBSpline] | Floats"]

DOMAIN_COLOUR, BOUNDARY_COLOUR, DISC_COLOUR, TEXT_COLOUR = "#f3f1ea", "#33343a", "#3a78b4", "#33343a"
PAPER = "background:#fff"  # so that words can be read on a dark page, too
ROW = 24.0  # pixels, of the explanations under the picture
LETTER = 7.2  # pixels, about the width of one
SWATCH = 28.0  # pixels, length of a sample of colour
SCALE_STEPS = 24  # colours of a field
OVERLAP = 0.5  # pixels by which a cell lies over the next, so that nothing shines through between them


class Picture:
    """A picture of a domain, to draw on in layers.

    Parameters
    ----------
    domain : Domain
        Filled lightly; its boundary is a layer of its own, `boundary`.
    width : int
        Of the larger side, in pixels.
    around : iterable of iterables of RationalBSpline
        Curves outside the domain for which there must be room, such as outward offsets.
    """

    def __init__(self, domain: Domain, width: int = 800, around: Curves = ()) -> None:
        self.domain = domain
        self.frame = Frame(hull_box((c for path in around for c in path), domain.bbox), width)
        self._tolerance = rounding(domain)
        self._outline = outline_path(domain, self.frame)
        self._layers = [f'<path fill="{DOMAIN_COLOUR}" fill-rule="evenodd" d="{self._outline}"/>']
        self._entries: list[tuple[str, str, float]] = []  # what explains a colour: a drawing, its text, its width

    # Layers ------------------------------------------------------------------------------------------------------
    def boundary(self, colour: str = BOUNDARY_COLOUR, width: float = 1.4) -> Picture:
        """The boundary of the domain, in pixels wide."""
        stroke = f'fill="none" stroke="{colour}" stroke-width="{width:g}" stroke-linejoin="round"'
        return self._add(f'<path {stroke} d="{self._outline}"/>')

    def region(self, paths: Paths | None = None, colour: str = DISC_COLOUR, opacity: float = 1.0, label: str = "") -> Picture:
        """Fill what closed paths enclose, holes left out (even-odd); the domain itself without paths."""
        path = self._outline if paths is None else self._path(paths)
        self._explain(f'<rect width="{SWATCH:g}" height="12" y="-6" fill="{colour}" fill-opacity="{opacity:g}"/>', label)
        return self._add(f'<path fill="{colour}" fill-opacity="{opacity:g}" fill-rule="evenodd" d="{path}"/>' if path else "")

    def lines(self, paths: Paths, colour: str = DISC_COLOUR, width: float = 1.4, label: str = "") -> Picture:
        """Draw curves, head to tail along each path, closed or open; `width` in pixels."""
        stroke = f'fill="none" stroke="{colour}" stroke-width="{width:g}" stroke-linejoin="round" stroke-linecap="round"'
        self._explain(f'<path {stroke} d="M0 0h{SWATCH:g}"/>', label)
        path = self._path(paths)
        return self._add(f'<path {stroke} d="{path}"/>' if path else "")

    def axis(self, axis: MedialAxis, width: float = 2.0) -> Picture:
        """Draw an axis coloured by its radius, from small, light, to large, dark."""
        strokes = "".join(axis_strokes(axis, self.frame))
        return self._add(f'<g fill="none" stroke-width="{width:g}" stroke-linecap="round">{strokes}</g>')

    def discs(self, rows: ArrayLike, colour: str = DISC_COLOUR, opacity: float = 0.08, label: str = "") -> Picture:
        """Draw discs, (n, 3) rows x, y, r in the caller's unit, lightly filled."""
        style = f'fill="{colour}" fill-opacity="{opacity:g}" stroke="{colour}"'
        self._explain(f'<circle {style} r="6" cx="{0.5 * SWATCH:g}"/>', label)
        discs = _rows(rows)
        places = self.frame.points(discs[:, :2]).tolist()
        shapes = (f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{r:.2f}"/>'
                  for (x, y), r in zip(places, (discs[:, 2] * self.frame.scale).tolist(), strict=True))
        return self._add(f'<g {style}>{"".join(shapes)}</g>')

    def brush(self, rows: ArrayLike, colour: str = DISC_COLOUR, label: str = "") -> Picture:
        """Draw a stroke as wide as its discs, (n, 3) rows x, y, r along it, with round ends; `sample` methods give such."""
        self._explain(f'<path stroke="{colour}" stroke-width="9" stroke-linecap="round" d="M4 0h{SWATCH - 8:g}"/>', label)
        discs = _rows(rows)
        if len(discs) == 1:
            discs = np.repeat(discs, 2, axis=0)
        places = self.frame.points(discs[:, :2])
        widths = self.frame.scale * (discs[1:, 2] + discs[:-1, 2])
        shapes = (f'<path stroke-width="{w:.2f}" d="M{numbers(a)}L{numbers(b)}"/>'
                  for a, b, w in zip(places[:-1], places[1:], widths.tolist(), strict=True))
        return self._add(f'<g stroke="{colour}" stroke-linecap="round">{"".join(shapes)}</g>')

    def field(self, x: ArrayLike, y: ArrayLike, values: ArrayLike, label: str = "") -> Picture:
        """Colour the domain by values on a grid, small ones light.

        Parameters
        ----------
        x, y : (n,), (m,) array_like
            Coordinates of the grid, evenly spaced, at least two of each.
        values : (m, n) array_like
            One for each cell around a point of the grid; NaN leaves it out.
        label : str
            What they are; the scale with its ends is shown under the picture.

        Raises
        ------
        UnsupportedOption
            The shapes do not fit, or no value is a number.
        """
        across, up, content = (np.asarray(a, dtype=float) for a in (x, y, values))
        if across.ndim != 1 or up.ndim != 1 or min(len(across), len(up)) < 2 or content.shape != (len(up), len(across)):
            raise UnsupportedOption("values", f"shape {content.shape} does not fit x {across.shape} and y {up.shape}")
        if not np.isfinite(content).any():
            raise UnsupportedOption("values", "there is no number among them")
        low, high = float(np.nanmin(content)), float(np.nanmax(content))
        share = (content - low) / (high - low) if high > low else np.zeros_like(content)
        level = np.where(np.isfinite(share), np.minimum(SCALE_STEPS * np.nan_to_num(share), SCALE_STEPS - 1), -1).astype(int)
        clip = f"inside{len(self._layers)}"
        shapes = "".join(f'<path fill="{colour}" d="{path}"/>' for colour, path in _runs(across, up, level, self.frame) if path)
        self._scale(low, high, label)
        return self._add(f'<clipPath id="{clip}"><path d="{self._path(_oriented(self.domain))}"/></clipPath>'
                         f'<g clip-path="url(#{clip})">{shapes}</g>')

    # Output ------------------------------------------------------------------------------------------------------
    def to_svg(self) -> str:
        """The picture as an SVG document that needs nothing else."""
        rows, height = self._explanations()
        w, h = f"{self.frame.width:.6g}", f"{self.frame.height + height:.6g}"
        size = f'width="{w}" height="{h}" viewBox="0 0 {w} {h}"'
        head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" style="{PAPER}">'
        return "\n".join([head, *self._layers, *rows, "</svg>"]) + "\n"

    def _repr_svg_(self) -> str:
        """What a notebook shows."""
        return self.to_svg()

    def save(self, path: str | Path) -> None:
        """Write the SVG document to a file."""
        Path(path).write_text(self.to_svg(), encoding="utf-8")

    # Inside ------------------------------------------------------------------------------------------------------
    def _add(self, layer: str) -> Picture:
        if layer:
            self._layers.append(layer)
        return self

    def _path(self, paths: Paths) -> str:
        """All paths as the commands of one."""
        out = ""
        for path in paths:
            if isinstance(path, np.ndarray):
                out += _polyline(self.frame.points(path))
                continue
            curves = list(path)
            if shapes := primitives(curves, self._tolerance):
                out += path_of(shapes, self.frame, is_closed(curves, self.domain.size))
        return out

    def _explain(self, swatch: str, label: str) -> None:
        if label:
            self._entries.append((swatch, label, SWATCH))

    def _scale(self, low: float, high: float, label: str) -> None:
        """The colours of a field side by side, with both ends in the text."""
        if label:
            colours = enumerate(colour_scale(SCALE_STEPS))
            bars = "".join(f'<rect x="{4 * i}" y="-6" width="4.5" height="12" fill="{c}"/>' for i, c in colours)
            self._entries.append((bars, f"{label}, {low:.3g} to {high:.3g}", 4.0 * SCALE_STEPS))

    def _explanations(self) -> tuple[list[str], float]:
        """The labels, side by side as long as there is room, and the height they take."""
        out: list[str] = []
        x, y = MARGIN, self.frame.height + 0.25 * ROW
        for swatch, label, width in self._entries:
            taken = width + 8.0 + LETTER * len(label) + 20.0
            if x > MARGIN and x + taken > self.frame.width:
                x, y = MARGIN, y + ROW
            out.append(f'<g transform="translate({x:.2f} {y:.2f})">{swatch}<text x="{width + 8:g}" y="4.5" fill="{TEXT_COLOUR}"'
                       f' font-family="sans-serif" font-size="13">{escape(label)}</text></g>')
            x += taken
        return out, y + 0.75 * ROW - self.frame.height if out else 0.0


def _oriented(domain: Domain) -> Curves:
    """The loops, holes against the outer one: some programs clip by the non-zero rule only."""
    for i, loop in enumerate(domain.loops):
        anticlockwise = measure(list(loop))[0] > 0.0
        yield loop if anticlockwise == (i == 0) else [curve.reversed() for curve in reversed(loop)]


def _polyline(points: Floats) -> str:
    """Points in pixels as one path; nothing for fewer than two."""
    return f"M{numbers(points[0])}L{numbers(points[1:])}" if len(points) > 1 else ""


def _rows(rows: ArrayLike) -> Floats:
    """Discs as an array (n, 3)."""
    discs = np.atleast_2d(np.asarray(rows, dtype=float))
    if discs.ndim != 2 or discs.shape[1] != 3 or not np.isfinite(discs).all():
        raise UnsupportedOption("rows", f"an array of shape {discs.shape} is not one of finite numbers x, y, r, (n, 3)")
    return discs


def _runs(x: Floats, y: Floats, level: NDArray[np.int64], frame: Frame) -> Sequence[tuple[str, str]]:
    """(colour, path) of all cells of one level, those side by side as one rectangle."""
    half = 0.5 * np.array([(x[-1] - x[0]) / (len(x) - 1), (y[-1] - y[0]) / (len(y) - 1)])
    paths = [""] * SCALE_STEPS
    for row, own in zip(y.tolist(), level, strict=True):
        change = np.concatenate(([0], np.nonzero(np.diff(own))[0] + 1, [len(own)])).tolist()
        for first, last in pairwise(change):
            if own[first] >= 0:
                corners = frame.points(np.array([[x[first], row], [x[last - 1], row]]) + np.array([-half, half]))
                (a, b), (c, d) = corners.tolist()
                across, up = c - a + OVERLAP, b - d + OVERLAP
                paths[own[first]] += f"M{a:.1f} {b:.1f}h{across:.1f}v{-up:.1f}h{-across:.1f}z"
    return list(zip(colour_scale(SCALE_STEPS), paths, strict=True))
