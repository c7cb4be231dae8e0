"""True axis points in extended precision, from the boundary alone: what fitted curves are held against.

In the plane through a curve's point X that is square to the curve there, the true axis point (c, r) solves

    A(a) + r nA(a) = B(b) + r nB(b) = c,      ((c, r) - X) . X' = 0          for the footpoints a, b on both sides

by Newton's method in 80 bits, from the pieces of the boundary alone; what was traced is only where it starts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mat_core import MedialAxis
from mat_core.boundary.sites import SiteTable
from mat_core.kernels.layout import (
    ARC,
    CP0,
    DEG,
    FAN,
    K0,
    KIND,
    LINE,
    SPIRAL,
    SWEEP,
    TX0,
    TY0,
    X0,
    X0_LOW,
    X1,
    X1_LOW,
    Y0,
    Y0_LOW,
    Y1,
    Y1_LOW,
)
from mat_core.tracing.locate import locate

Wide = np.ndarray[Any, Any]
STEPS = 12
CONVERGED = 1e-17  # last step of r
SETTLED = 1e-8  # and of the footpoints' parameters
NEARBY = 0.25  # farther than this, in s, from where it starts a footpoint is that of another disc


def _bezier(control: Wide, s: Wide) -> tuple[Wide, Wide, Wide]:
    """Points and two derivatives of (n, d + 1, 3) rational Beziers at s (n,)."""
    h = control.copy()
    h[:, :, :2] *= h[:, :, 2:]
    found = []
    for _ in range(3):
        b = h
        while b.shape[1] > 1:
            b = (1 - s[:, None, None]) * b[:, :-1] + s[:, None, None] * b[:, 1:]
        found.append(b[:, 0] if h.shape[1] else np.zeros_like(control[:, 0]))
        h = (h.shape[1] - 1) * np.diff(h, axis=1)
    (a, a1, a2), w = found, found[0][:, 2:]
    c = a[:, :2] / w
    c1 = (a1[:, :2] - c * a1[:, 2:]) / w
    return c, c1, (a2[:, :2] - 2 * c1 * a1[:, 2:] - c * a2[:, 2:]) / w


def _left(v: Wide) -> Wide:
    return np.stack([-v[:, 1], v[:, 0]], axis=1)


def frames(table: SiteTable, site: Wide, s: Wide) -> tuple[Wide, Wide, Wide, Wide]:
    """Points, inward normals, and the derivatives of both by s: (n, 2) each."""
    p, n, p1, n1 = (np.zeros((len(site), 2), np.longdouble) for _ in range(4))
    kind = table.si[site, KIND]
    f = table.sf[site].astype(np.longdouble)
    p[:] = f[:, [X0, Y0]] + f[:, [X0_LOW, Y0_LOW]]
    k = kind == LINE
    way = (f[:, [X1, Y1]] - f[:, [X0, Y0]])[k]
    p[k] += s[k, None] * way
    p1[k], n[k] = way, _left(way) / np.hypot(*way.T)[:, None]
    k = (kind == ARC) | (kind == FAN)
    tangent = f[k][:, [TX0, TY0]] / np.hypot(*f[k][:, [TX0, TY0]].T)[:, None]
    sweep, curvature = f[k, SWEEP], np.where(kind[k] == ARC, f[k, K0], np.inf)
    sin, cos, half = np.sin(s[k] * sweep), np.cos(s[k] * sweep), np.sin(0.5 * s[k] * sweep)
    p[k] += (sin / curvature)[:, None] * tangent + (2 * half * half / curvature)[:, None] * _left(tangent)
    turned = cos[:, None] * tangent + sin[:, None] * _left(tangent)
    n[k], p1[k], n1[k] = _left(turned), (sweep / curvature)[:, None] * turned, -sweep[:, None] * turned
    for degree in np.unique(table.si[site[kind == SPIRAL], DEG]):
        k = np.flatnonzero((kind == SPIRAL) & (table.si[site, DEG] == degree))
        beziers = table.cp[table.si[site[k], CP0][:, None] + np.arange(degree + 1)].astype(np.longdouble)
        c, c1, c2 = _bezier(beziers, s[k])
        turned = c1 / np.hypot(*c1.T)[:, None]
        turn = (c1[:, 0] * c2[:, 1] - c1[:, 1] * c2[:, 0]) / (c1 * c1).sum(axis=1)
        # from the nearer end: neighbours share it to all digits
        late = s[k] > 0.5
        p[k] += c
        p[k[late]] = (f[k][:, [X1, Y1]] + f[k][:, [X1_LOW, Y1_LOW]] + c - beziers[:, -1, :2])[late]
        n[k], p1[k], n1[k] = _left(turned), c1, -turn[:, None] * turned
    return p, n, p1, n1


def off_axis(axis: MedialAxis, segment: Wide, t: Wide) -> Wide:
    """(n,) distance in (x, y, r) from the true axis, normalised; NaN where the method does not converge."""
    table = axis.table
    disc = axis.evaluate(segment, t)
    x = (disc[:, :3] - [*table.origin, 0.0]).astype(np.longdouble) * table.scale
    d = (disc[:, 3:] / np.linalg.norm(disc[:, 3:], axis=1)[:, None]).astype(np.longdouble)
    sites, s = _footpoints(axis, segment, t)
    first = s.copy()
    r = x[:, 2].copy()
    moved, step = np.full(len(t), np.inf), np.full((2, len(t)), np.inf)
    for _ in range(STEPS):
        (a, na, a1, na1), (b, nb, b1, nb1) = (frames(table, site, at) for site, at in zip(sites, s, strict=True))
        column = np.zeros((4, len(t), 3), np.longdouble)
        c = a + r[:, None] * na
        column[0, :, :2], column[1, :, :2] = a1 + r[:, None] * na1, -b1 - r[:, None] * nb1
        column[2, :, :2], column[3, :, :2] = na - nb, c - b - r[:, None] * nb
        column[0, :, 2] = (column[0, :, :2] * d[:, :2]).sum(axis=1)
        column[2, :, 2] = (na * d[:, :2]).sum(axis=1) + d[:, 2]
        column[3, :, 2] = ((c - x[:, :2]) * d[:, :2]).sum(axis=1) + (r - x[:, 2]) * d[:, 2]
        with np.errstate(invalid="ignore", divide="ignore"):
            det = _det(column[0], column[1], column[2])
            step = np.stack([_det(column[3], column[1], column[2]), _det(column[0], column[3], column[2])]) / det
            s -= step
            moved = _det(column[0], column[1], column[3]) / det
            r = r - moved
    p, n, _, _ = frames(table, sites[0], s[0])
    off = np.linalg.norm(np.column_stack([p + r[:, None] * n, r]) - x, axis=1)
    inside = np.all((s > -1e-9) & (s < 1 + 1e-9), axis=0)
    # beside a disc where both footpoints meet the equations are nearly dependent: they may wander while r rests
    settled = np.all((np.abs(step) < SETTLED) & (np.abs(s - first) < NEARBY), axis=0)
    return np.where((np.abs(moved) < CONVERGED) & settled & inside, off, np.nan).astype(float)


def _det(a: Wide, b: Wide, c: Wide) -> Wide:
    return (a * np.cross(b, c)).sum(axis=1)



def _footpoints(axis: MedialAxis, segment: Wide, t: Wide) -> tuple[Wide, Wide]:
    """Sites (2, n) and parameters (2, n) to start from."""
    c, k, table = axis.curves, axis.skeleton, axis.table
    located, sites = np.empty((5, len(t))), np.empty((2, len(t)), dtype=np.int64)
    work = np.empty((int(c.degree.max()) + 1, 4))
    locate(table.si, table.sf, table.cp, k.strip_i, k.strip_s, c.degree, c.knot_start, c.knots, c.cp_start, c.cp,
           c.max_error, c.part_start, c.part_i, c.part_f, segment, t, work, np.empty(6), np.empty(6), np.empty(5), located,
           sites)  # fmt: skip
    return sites, located[3:].astype(np.longdouble)
