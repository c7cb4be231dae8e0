"""The plot: everything is on the axes it was given, in the caller's coordinates."""

from __future__ import annotations

from collections.abc import Iterator

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")

from matplotlib import pyplot
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.patches import Circle

from mat_core.formats.plot import plot
from tests.curves.shapes import solved
from tests.formats.test_dxf import without


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    pyplot.close("all")


@pytest.mark.parametrize("name", ["rectangle", "annulus", "circle", "mixed_holes"])
def test_all_of_it_is_drawn_on_the_axes_given(name: str) -> None:
    axis = solved(name)
    figure, ax = pyplot.subplots()
    assert plot(axis, ax, discs=3, colorbar=True) is ax
    figure.canvas.draw()
    lines = [c for c in ax.collections if isinstance(c, LineCollection)]
    assert len(lines) == bool(axis.segments)
    drawn = sum(len(c.get_offsets()) for c in ax.collections if isinstance(c, PathCollection))
    assert drawn == len(axis.nodes)
    assert len([p for p in ax.patches if isinstance(p, Circle)]) == 2 * (3 if axis.segments else 1)
    xmin, ymin, xmax, ymax = axis.domain.bbox
    assert ax.get_xlim()[0] <= xmin < xmax <= ax.get_xlim()[1]
    assert ax.get_ylim()[0] <= ymin < ymax <= ax.get_ylim()[1]
    assert ax.get_aspect() == 1.0


def test_chords_follow_the_axis_with_its_radius() -> None:
    axis = solved("ell")
    ax = plot(axis, nodes=False)
    assert ax is pyplot.gca()
    (lines,) = (c for c in ax.collections if isinstance(c, LineCollection))
    chords, radii = np.array(lines.get_segments()), np.asarray(lines.get_array())
    assert np.hypot(*(chords[:, 1] - chords[:, 0]).T).sum() == pytest.approx(axis.lengths.sum(), rel=1e-3)
    assert radii.max() == pytest.approx(axis.node_discs[:, 2].max(), rel=0.02)


def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, "matplotlib")
    with pytest.raises(ImportError, match=r"mat-core\[plot\]"):
        plot(solved("rectangle"))
