"""Parts of a rebuilt loop that do not quite meet."""

from __future__ import annotations

import numpy as np
import pytest

from mat_core.analysis.rebuilding.closing import Part, Vertex, closed

SQUARE = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.mark.parametrize("start_leg", [1e-7, 1e-3, 0.3])
@pytest.mark.parametrize("apart", [1e-9, 1e-6])
def test_a_slow_start_is_not_led_back_past_where_it_turns(start_leg: float, apart: float) -> None:
    bottom = np.column_stack(([0.0, start_leg, 0.5, 1.0], np.zeros(4)))
    rest = np.linspace(SQUARE[:-1], SQUARE[1:], 4, axis=1)
    vertex = np.array([-apart, 0.0])
    last = np.linspace(SQUARE[-1], [0.0, 0.0], 4)
    curves = closed([Part([bottom], None, None), *(Part([side], None, None) for side in rest), Part([last], None, None),
                     Part([], None, Vertex(vertex, np.empty((0, 3))))])
    assert curves[0].control_points[0].tolist() == vertex.tolist()
    assert (np.diff(curves[0].control_points[:, 0]) > 0.0).all()
