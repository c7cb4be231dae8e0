"""The combinatorial axis: every disc with its contacts, every strip between two discs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Skeleton(NamedTuple):
    """The axis before it is traced; normalised coordinates.

    disc (D, 3): x, y, r. disc_kind (D,): THROUGH, VERTEX_LEAF, CURVATURE_LEAF or ARC_CONTACT. contact_start (D + 1,),
    contact_site (C,), contact_s (C,): the contacts of each disc. strip_i (S, 4): site_a, site_b, disc0, disc1; strip_s (S, 4):
    a0, a1, b0, b1: from disc0 to disc1 the right side runs up site_a from a0 to a1, the left side down site_b from b0 to b1.
    whole_i (A, 2): site, disc and whole_s (A, 2): lo, hi of boundary arcs in contact along their length.
    faces: number of faces the discs cut the domain into.
    """

    disc: NDArray[np.float64]
    disc_kind: NDArray[np.int64]
    contact_start: NDArray[np.int64]
    contact_site: NDArray[np.int64]
    contact_s: NDArray[np.float64]
    strip_i: NDArray[np.int64]
    strip_s: NDArray[np.float64]
    whole_i: NDArray[np.int64]
    whole_s: NDArray[np.float64]
    faces: int
