"""A medial axis on the axes of matplotlib, for notebooks and papers (extra ``plot``).

The same picture as `mat_core.formats.svg` draws, in the caller's coordinates: fill, maximal discs, axis coloured by radius,
boundary, nodes. Matplotlib is imported when it is asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mat_core.formats.beziers import chains, pieces_of
from mat_core.formats.geojson import disc_pieces
from mat_core.formats.svg import colour_scale

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]

CHORDS = 2e-4  # of the size: what chords may stray from their curves; a pixel of a large picture
CHORD_LENGTH = 0.01  # of the size: longest chord of the axis, which has one colour
SHADES = 256
NODE_COLOURS = {
    "branch": "#1d2a5b",
    "point": "#1d2a5b",
    "convex_vertex": "#f0793f",
    "curvature_center": "#c2185b",
    "arc_center": "#2a8c6c",
}
BOUNDARY_COLOUR, FILL_COLOUR, DISC_COLOUR = "#33343a", "#f3f1ea", "#3a78b4"


def plot(
    axis: MedialAxis,
    ax: Any = None,
    *,
    discs: int = 0,
    nodes: bool = True,
    colorbar: bool = False,
    linewidth: float = 2.0,
) -> Any:
    """Draw a medial axis with matplotlib.

    Parameters
    ----------
    axis : MedialAxis
    ax : matplotlib.axes.Axes, optional
        Where to draw; the current axes of pyplot when left out.
    discs : int
        How many maximal discs to show, evenly along the longest segments; 0 for none.
    nodes : bool
        Whether to show the nodes, coloured by kind.
    colorbar : bool
        Whether to add a scale of the radius to the figure.
    linewidth : float
        Of the axis, in points.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, with equal scales.

    Raises
    ------
    ImportError
        Matplotlib is not installed.
    """
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plotting needs the package matplotlib: pip install 'mat-core[plot]'") from error
    ax = pyplot.gca() if ax is None else ax
    _draw_domain(axis, ax)
    _draw_discs(axis, ax, discs)
    lines = _draw_curves(axis, ax, linewidth)
    if nodes:
        _draw_nodes(axis, ax)
    if colorbar and lines is not None:
        ax.figure.colorbar(lines, ax=ax, label="radius")
    ax.set_aspect("equal")
    ax.autoscale_view()
    return ax


def _draw_domain(axis: MedialAxis, ax: Any) -> None:
    """The inside below everything, the boundary above the axis."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    outline = Path.make_compound_path(*(Path(ring, closed=True) for ring in _rings(axis)))
    ax.add_patch(PathPatch(outline, facecolor=FILL_COLOUR, edgecolor="none", zorder=1))
    ax.add_patch(PathPatch(outline, facecolor="none", edgecolor=BOUNDARY_COLOUR, linewidth=1.2, zorder=4))


def _draw_curves(axis: MedialAxis, ax: Any, linewidth: float) -> Any:
    """The segments, coloured by radius: what a scale can be made for; None where there is no segment."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap

    chords, radii = _chords(axis)
    if not chords:
        return None
    colours = LinearSegmentedColormap.from_list("radius", colour_scale(), SHADES)
    lines = LineCollection(chords, cmap=colours, linewidths=linewidth, capstyle="round", zorder=3)
    lines.set_array(radii)
    lines.set_clim(0.0, float(radii.max()))
    ax.add_collection(lines)
    return lines


def _rings(axis: MedialAxis) -> list[Floats]:
    """The loops as closed chains."""
    tolerance = CHORDS * axis.domain.size
    loops = (axis.domain.outer, *axis.domain.holes)
    return [np.vstack(chains([pieces_of(edge) for edge in loop], tolerance)) for loop in loops]


def _chords(axis: MedialAxis) -> tuple[list[Floats], Floats]:
    """Chords (2, 2) of all segments, short enough for one colour each, and the radii (n,) in their middles."""
    size = axis.domain.size
    chords: list[Floats] = []
    radii: list[Floats] = []
    for discs in chains([disc_pieces(segment) for segment in axis.segments], CHORDS * size):
        steps = np.hypot(*np.diff(discs[:, :2], axis=0).T)
        count = np.maximum(np.ceil(steps / (CHORD_LENGTH * size)), 1.0)
        at = np.concatenate(([0.0], np.cumsum(count)))
        fine = np.arange(int(at[-1]) + 1)
        x, y, r = (np.interp(fine, at, column) for column in discs.T)
        points = np.column_stack((x, y))
        chords.extend(np.stack((points[:-1], points[1:]), axis=1))
        radii.append(0.5 * (r[1:] + r[:-1]))
    return chords, np.concatenate(radii) if radii else np.empty(0)


def _draw_discs(axis: MedialAxis, ax: Any, count: int) -> None:
    """`count` discs, spread over the segments by their lengths; a domain that is a disc has one."""
    from matplotlib.patches import Circle

    lengths = axis.lengths
    if len(lengths):
        total = np.cumsum(lengths)
        wanted = (np.arange(count) + 0.5) / max(count, 1) * total[-1]
        segment = np.searchsorted(total, wanted)
        shares = 1.0 - (total[segment] - wanted) / lengths[segment]
        shown = axis.evaluate(segment, shares)[:, :3]
    else:
        shown = axis.node_discs[:count]
    for x, y, r in shown.tolist():
        ax.add_patch(Circle((x, y), r, facecolor=DISC_COLOUR, alpha=0.07, linewidth=0.0, zorder=2))
        ax.add_patch(Circle((x, y), r, facecolor="none", edgecolor=DISC_COLOUR, alpha=0.5, linewidth=0.7, zorder=2))


def _draw_nodes(axis: MedialAxis, ax: Any) -> None:
    """One scatter for each kind, so that a legend can name them."""
    for kind, colour in NODE_COLOURS.items():
        places = [node.point for node in axis.nodes if node.kind == kind]
        if places:
            x, y = zip(*places, strict=True)
            ax.scatter(x, y, s=14, color=colour, edgecolors="white", linewidths=0.5, zorder=5, label=kind.replace("_", " "))
