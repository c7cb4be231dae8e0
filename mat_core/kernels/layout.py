"""Columns of the flat tables that every stage shares: named once, here.

A *site* is what a maximal disc may touch: a boundary piece (LINE, ARC, SPIRAL) or the point of a reflex vertex with its
range of normals (FAN). Sites stand in loop order with the interior on the left. `si` holds the integers of a site, `sf`
the floats, `cp` the control points (x, y, weight) of its Bezier piece, x and y relative to the site's start (X0, Y0).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SiteInts = NDArray[np.int32]
"""si: (n, SI_WIDTH)."""

LINE, ARC, SPIRAL, FAN = 0, 1, 2, 3

# si: integers of a site
KIND, DEG, CP0, RATIONAL, NEXT, PREV, V0, V1, LOOP, EDGE, SPAN, CORNER, KNOWN, GOES_ON = range(14)
SI_WIDTH = 14

# sf: floats of a site
X0, Y0, X1, Y1, TX0, TY0, TX1, TY1, K0, K1, LEN, SWEEP, UA, UB, SKEW, XMIN, YMIN, XMAX, YMAX = range(19)
X0_LOW, Y0_LOW, X1_LOW, Y1_LOW = range(19, 23)  # what is left of the ends beyond the digits of X0 .. Y1
SF_WIDTH = 23

# SKEW q: the input edge's parameter at s on the site's Bezier is UA + (UB - UA) s / (s + q (1 - s))
# KNOWN: 1 for an ARC whose curvature comes from the derivatives of its Bezier, not from a circle through its points
# GOES_ON: 1 for the first site of a Bezier that begins at a knot of less than full multiplicity: in the last one's direction
# CORNER: the joint at the start of a site
SMOOTH_JOINT, CONVEX_VERTEX = 0, 1

# Kinds of discs
THROUGH, VERTEX_LEAF, CURVATURE_LEAF, ARC_CONTACT = 0, 1, 2, 3
