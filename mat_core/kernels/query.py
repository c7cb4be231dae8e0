"""The maximal-disc query: which site the growing disc tangent at a boundary point touches first, by a walk through the boxes."""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import IN_LOOP_ORDER, distance_sq
from mat_core.kernels.curve import evaluate
from mat_core.kernels.disc import origin_end, touch
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, FAN, KIND, NEXT, PREV, X0, X1, Y0, Y1

ROUNDING = 2e-15  # of a centre and of the sides of a box, in normalised coordinates
GREEDY_STEPS = 64
BESIDE = 1e-7  # radii; a foot this near to a convex vertex may lie on either side of it, as far as distances tell


@inner
def touch_candidate(si, sf, cp, i, j, d0x, d0y, d1x, d1y, nx, ny):
    """`touch` of site j from a point of site i (d0, d1: that point relative to i's ends)."""
    if origin_end(si, i, j, d0x * d0x + d0y * d0y <= d1x * d1x + d1y * d1y) == 0:
        return touch(si, sf, cp, j, 0.0, 1.0, sf[i, X0], sf[i, Y0], d0x, d0y, nx, ny)
    return touch(si, sf, cp, j, 0.0, 1.0, sf[i, X1], sf[i, Y1], d1x, d1y, nx, ny)


@inner
def _nearest_leaf(tree, v, cx, cy):
    """The site that walking down from v to the nearer box leads to: near the point, seldom the nearest."""
    leaves = tree.site.shape[0]
    while v < leaves:
        v *= 2
        if distance_sq(tree.box, v + 1, cx, cy) < distance_sq(tree.box, v, cx, cy):
            v += 1
    return tree.site[v - leaves]


@inner
def _pass_on(si, sf, cp, i, skip, px, py, d0x, d0y, d1x, d1y, nx, ny, best, j, s):
    """(site, s) of a contact found at s on site j near one of its ends, where the next site touches the disc as well.

    A contact at the very end is tangent there only if the site beyond does not take it over; a fan passes it on. Beside a convex
    vertex that turns by little both sides touch but for rounding: the disc touches the one on which its foot is farther from the
    vertex.
    """
    forward = s > 0.5
    while True:
        beyond = si[j, NEXT] if forward else si[j, PREV]
        corner = beyond if forward else j
        vx = sf[corner, X0]
        vy = sf[corner, Y0]
        qx, qy, tx, ty, k, speed = evaluate(si, sf, cp, j, s, vx, vy)
        depth = qx * qx + qy * qy
        fan = si[j, KIND] == FAN or si[beyond, KIND] == FAN
        convex = not fan and si[corner, CORNER] == CONVEX_VERTEX and depth * best * best < BESIDE * BESIDE
        at_end = s >= 1.0 if forward else s <= 0.0
        if beyond == i or beyond == skip or not (at_end or convex):
            break
        phi, sj = touch_candidate(si, sf, cp, i, beyond, d0x, d0y, d1x, d1y, nx, ny)
        # both values are of one point, but for rounding: that of phi is the coordinates' over the squared distance
        qx += vx - px
        qy += vy - py
        inside = 0.0 < sj < 1.0
        through = si[beyond, KIND] == FAN and (sj >= 1.0 if forward else sj <= 0.0)
        if phi < best * (1.0 - 1e-12) - ROUNDING / (qx * qx + qy * qy) or not (inside or through):
            break
        if convex:
            qx, qy, tx, ty, k, speed = evaluate(si, sf, cp, beyond, sj, vx, vy)
            if qx * qx + qy * qy <= depth:
                break
        j = beyond
        s = sj
        if inside:
            break
    return j, s


@inner
def _shrink(si, sf, cp, tree, i, px, py, d0x, d0y, d1x, d1y, nx, ny, skip, hint, best, best_j, best_s):
    """(phi, site, s) of some site that the disc reaches, a small one: by what stands near p in the tree, then near its centre.

    A disc that reaches across the domain meets boundary everywhere. By nothing where nothing is that the hint did not meet.
    """
    r = 1.0 / best
    limit = (r + ROUNDING) * (r + ROUNDING)
    cx = px + r * nx
    cy = py + r * ny
    climbs = si.shape[0] > IN_LOOP_ORDER
    v = tree.leaf[i] if climbs and best_j < 0 else 1
    steps = 0
    while steps < GREEDY_STEPS:
        climbing = v > 1
        if climbing:
            side = v ^ 1
            v //= 2
            if distance_sq(tree.box, side, cx, cy) >= limit:
                continue
            j = _nearest_leaf(tree, side, cx, cy)
        else:
            j = _nearest_leaf(tree, 1, cx, cy)
        steps += 1
        phi = -math.inf
        sj = 0.0
        if j >= 0 and j != i and j != skip and j != hint and j != best_j:
            phi, sj = touch_candidate(si, sf, cp, i, j, d0x, d0y, d1x, d1y, nx, ny)
        if phi <= best:
            if climbing:
                continue
            break
        if climbs and steps == 1 and not climbing:
            v = tree.leaf[i]
        best = phi
        best_j = j
        best_s = sj
        r = 1.0 / best
        limit = (r + ROUNDING) * (r + ROUNDING)
        cx = px + r * nx
        cy = py + r * ny
    return best, best_j, best_s


@inner
def query(si, sf, cp, tree, stack, i, s, nx, ny, skip, hint, k_low):
    """The first site that the growing disc tangent at s on site i, with inward normal n, touches: (phi, site, s_site).

    Sites `i` and `skip` are left out; `hint` is tried first; `k_low` > 0 is a lower bound on the answer (no disc of the domain
    is larger than 1 / k_low). Returns site -1 if nothing has phi > k_low.
    """
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    d0x, d0y, tx, ty, k, speed = evaluate(si, sf, cp, i, s, sf[i, X0], sf[i, Y0])
    d1x, d1y, tx, ty, k, speed = evaluate(si, sf, cp, i, s, sf[i, X1], sf[i, Y1])
    best = k_low
    best_j = -1
    best_s = 0.0
    if hint >= 0 and hint != i and hint != skip:
        phi, sj = touch_candidate(si, sf, cp, i, hint, d0x, d0y, d1x, d1y, nx, ny)
        if phi > best:
            best = phi
            best_j = hint
            best_s = sj
    best, best_j, best_s = _shrink(si, sf, cp, tree, i, px, py, d0x, d0y, d1x, d1y, nx, ny, skip, hint, best, best_j, best_s)
    r = 1.0 / best
    limit = (r + ROUNDING) * (r + ROUNDING)
    cx = px + r * nx
    cy = py + r * ny
    leaves = tree.site.shape[0]
    box = tree.box
    seen = best_j
    top = 0
    stack[0] = 1
    while top >= 0:
        v = stack[top]
        top -= 1
        if distance_sq(box, v, cx, cy) >= limit:
            continue
        if v < leaves:
            left = distance_sq(box, 2 * v, cx, cy)
            right = distance_sq(box, 2 * v + 1, cx, cy)
            near = 2 * v if left <= right else 2 * v + 1
            if max(left, right) < limit:
                top += 1
                stack[top] = 4 * v + 1 - near
            if min(left, right) < limit:
                top += 1
                stack[top] = near
            continue
        j = tree.site[v - leaves]
        if j == i or j == skip or j == hint or j == seen:
            continue
        phi, sj = touch_candidate(si, sf, cp, i, j, d0x, d0y, d1x, d1y, nx, ny)
        if phi > best:
            best = phi
            best_j = j
            best_s = sj
            r = 1.0 / best
            limit = (r + ROUNDING) * (r + ROUNDING)
            cx = px + r * nx
            cy = py + r * ny
    if best_j >= 0:
        best_j, best_s = _pass_on(si, sf, cp, i, skip, px, py, d0x, d0y, d1x, d1y, nx, ny, best, best_j, best_s)
    return best, best_j, best_s
