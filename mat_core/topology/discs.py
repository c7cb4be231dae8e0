"""One maximal disc at every joint of the boundary, found by one global query each, whatever their order.

A joint (the start of site j, written (j, 0)) is either a convex vertex (leaf, r = 0), or its own curvature wins against all
other sites (leaf: centre of curvature; or a whole circular arc in contact), or the disc touches another site, the winner.
A boundary point has exactly one maximal disc, so discs found from different contacts may be the same one: see `topology.unite`.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.disc import touch
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    ARC,
    ARC_CONTACT,
    CONVEX_VERTEX,
    CORNER,
    CURVATURE_LEAF,
    EDGE,
    FAN,
    K0,
    K1,
    KIND,
    LOOP,
    NEXT,
    PREV,
    THROUGH,
    TX0,
    TX1,
    TY0,
    TY1,
    V0,
    V1,
    VERTEX_LEAF,
    X0,
    X1,
    Y0,
    Y1,
)
from mat_core.kernels.query import query
from mat_core.topology.unite import COORDINATE, arc_noise

OWN_RELATIVE = 1e-13  # own curvature wins on a spiral when no other site is better by more than rounding
BESIDE = 1e-4  # radii between a contact and an end of a site, within which the two look alike from afar
CLEARLY = 1e-6  # relative difference of curvatures seen across a nearly smooth corner that is no rounding
CHAIN = 4  # pieces between a joint and a contact that is near it
STRAIGHT = 1e-14  # radians; a joint that turns by less has one normal
TANGENT = 1e-15  # radians; what a unit tangent is known to, some roundings
SHARP = 1e16  # of 1 - k r: where a side curves away as fast as this, its foot lies at the joint
K_LOW = 1.9  # no disc in a domain of size at most 1 has a radius over 1/2

OK, NO_PARTNER, TOO_SMALL, UNCONNECTED, NOT_EULER = range(5)


@inner
def joint_normal(si, sf, j):
    """Inward unit normal at the start of site j; the mean of both sides at a smooth joint."""
    before = si[j, PREV]
    if si[j, KIND] == FAN:
        tx = sf[before, TX1]
        ty = sf[before, TY1]
    elif si[before, KIND] == FAN:
        tx = sf[j, TX0]
        ty = sf[j, TY0]
    else:
        tx = sf[before, TX1] + sf[j, TX0]
        ty = sf[before, TY1] + sf[j, TY0]
        length = math.sqrt(tx * tx + ty * ty)
        tx /= length
        ty /= length
    return -ty, tx


@inner
def _across(si, sf, j, r):
    """(bent, nx, ny): inward unit normal of the disc of radius r that touches both sides of a convex joint that is smoothed.

    Seen from its centre the joint lies a and b beyond the two feet, a^2 / (1 - k r) is the same for both sides, and a + b is r
    times what the joint turns by. The mean normal is that of sides that are curved alike; where one of them is nearly
    concentric with the disc it is off by half the turn, and the disc along it reaches beyond the boundary. Not bent: there is
    nothing to choose from, or too little of it to tell.
    """
    before = si[j, PREV]
    if si[j, KIND] == FAN or si[before, KIND] == FAN:
        return False, 0.0, 0.0
    turn = sf[before, TX1] * sf[j, TY0] - sf[before, TY1] * sf[j, TX0]
    if not turn > STRAIGHT:
        return False, 0.0, 0.0
    left = math.sqrt(min(max(1.0 - sf[before, K1] * r, 0.0), SHARP))
    right = math.sqrt(min(max(1.0 - sf[j, K0] * r, 0.0), SHARP))
    tx = right * sf[before, TX1] + left * sf[j, TX0]
    ty = right * sf[before, TY1] + left * sf[j, TY0]
    length = math.sqrt(tx * tx + ty * ty)
    if length == 0.0:
        return False, 0.0, 0.0
    return True, -ty / length, tx / length


@inner
def own_normal(si, sf, j, right):
    """Inward unit normal at the start of site j of the piece that starts there (`right`), or of the one that ends there."""
    if right:
        return -sf[j, TY0], sf[j, TX0]
    before = si[j, PREV]
    return -sf[before, TY1], sf[before, TX1]


@inner
def _grows(at_joint, far):
    """Curvature grows from the joint along a monotone piece, beyond rounding."""
    return far - at_joint > 1e-12 * abs(at_joint)


@inner
def _chained(si, j, winner):
    """Whether a site ends, a few pieces back, where the edge of joint j begins, or is one of these pieces.

    The pieces of an edge are laid from its start on with more digits than a coordinate has.
    """
    i = si[j, PREV]
    for _ in range(CHAIN):
        if i == winner:
            return True
        if si[i, KIND] == FAN or si[i, EDGE] != si[j, EDGE] or si[i, LOOP] != si[j, LOOP]:
            return False
        i = si[i, PREV]
    return False


@inner
def _phi_noise(si, sf, cp, j, winner, s):
    """Rounding of phi at a contact of the disc at joint j: that of the coordinates over the squared distance.

    Nothing where the contact's site meets the joint: it is taken relative to that. Where the way between them is known to more
    digits only that of the normal is left.
    """
    if winner < 0 or si[winner, V0] == si[j, V0] or si[winner, V1] == si[j, V0]:
        return 0.0
    dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, winner, s, sf[j, X0], sf[j, Y0])
    distance_sq = dx * dx + dy * dy
    if _chained(si, j, winner):
        return 2.0 * TANGENT / math.sqrt(distance_sq)
    return 2.0 * COORDINATE / distance_sq


@inner
def _past_corner(si, sf, cp, j, nx, ny, winner, s, phi):
    """(phi, site, s): what the disc at joint j, normal n, touches where its winner, touched at s, ends at a nearly flat corner.

    From afar both sides of such a corner look alike. Seen from the contact on one side, what is known relative to their common
    vertex tells whether the disc reaches through the other one: then it touches that one, just before the corner.
    """
    at_start = s < 0.5
    other = si[winner, PREV] if at_start else si[winner, NEXT]
    if si[winner if at_start else other, CORNER] != CONVEX_VERTEX or not 0.0 < s < 1.0 or other == j or other == si[j, PREV]:
        return phi, winner, s
    ox = sf[winner, X0] if at_start else sf[winner, X1]
    oy = sf[winner, Y0] if at_start else sf[winner, Y1]
    dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, winner, s, ox, oy)
    if math.sqrt(dx * dx + dy * dy) * phi > BESIDE:
        return phi, winner, s
    seen, seen_s = touch(si, sf, cp, other, 0.0, 1.0, ox, oy, dx, dy, -ty, tx)
    if seen > phi * (1.0 + CLEARLY):
        value, at = touch(si, sf, cp, other, 0.0, 1.0, sf[j, X0], sf[j, Y0], 0.0, 0.0, nx, ny)
        if 0.0 < at < 1.0:
            return value, other, at
    return phi, winner, s


@inner
def joint_disc(si, sf, cp, tree, stack, j, hint, tie, disc, whole):
    """(status, kind, x, y, r, winner, s): the maximal disc at the start of site j.

    Row `whole` of `disc` is one that touches along an arc (-1: none is known yet): an arc on the same circle touches it, too.
    Without it each tooth of a gear would ask all other teeth.

    kind THROUGH: it touches `winner` at s; VERTEX_LEAF; CURVATURE_LEAF; ARC_CONTACT: winner is 1 if the arc that starts here
    is in contact, 2 if the one that ends here, 3 if both are (one circle).
    """
    px = sf[j, X0]
    py = sf[j, Y0]
    if si[j, CORNER] == CONVEX_VERTEX:
        return OK, VERTEX_LEAF, px, py, 0.0, -1, 0.0
    before = si[j, PREV]
    nx, ny = joint_normal(si, sf, j)
    kl = sf[before, K1]
    kr = sf[j, K0]
    own = max(kl, kr)
    left = kl >= own - 1e-9 * abs(own)
    right = kr >= own - 1e-9 * abs(own)
    arcs = (1 if right and si[j, KIND] == ARC else 0) + (2 if left and si[before, KIND] == ARC else 0)
    rough = max(arc_noise(si, sf, j) if arcs & 1 else 0.0, arc_noise(si, sf, before) if arcs & 2 else 0.0)
    if arcs > 0 and own > 0.0 and whole >= 0:
        r = 1.0 / own
        ox, oy = own_normal(si, sf, j, arcs & 1)
        off = math.sqrt((px + r * ox - disc[whole, 0]) ** 2 + (py + r * oy - disc[whole, 1]) ** 2) + abs(r - disc[whole, 2])
        if off <= max(0.25 * tie, 2.0 * rough) * r:
            return OK, ARC_CONTACT, px + r * ox, py + r * oy, r, arcs, 0.0
    phi, winner, s = query(si, sf, cp, tree, stack, j, 0.0, nx, ny, before, hint, K_LOW)
    if arcs > 0 and own >= phi * (1.0 - max(tie, 2.0 * rough)):
        # about the arc's own centre: at a joint that is smooth but for noise the mean normal does not point at it
        nx, ny = own_normal(si, sf, j, arcs & 1)
        return OK, ARC_CONTACT, px + nx / own, py + ny / own, 1.0 / own, arcs, 0.0
    noise = _phi_noise(si, sf, cp, j, winner, s)
    # an osculating disc that touches elsewhere as well is no leaf: the branch to it has no length
    elsewhere = 0.0 < noise < tie * own and phi >= own * (1.0 - tie)
    if own >= max(phi * (1.0 - OWN_RELATIVE) - noise, K_LOW) and not elsewhere:
        grows = (left and _grows(kl, sf[before, K0])) or (right and _grows(kr, sf[j, K1]))
        if not grows or winner < 0:
            nx, ny = own_normal(si, sf, j, arcs & 1 if arcs > 0 else right)
            # an arc so short that its other end ties but for rounding is in contact whole all the same
            kind = ARC_CONTACT if arcs > 0 else CURVATURE_LEAF
            return OK, kind, px + nx / own, py + ny / own, 1.0 / own, arcs if arcs > 0 else -1, 0.0
    if winner < 0:
        return NO_PARTNER, THROUGH, px, py, 0.0, -1, 0.0
    bent, ax, ay = _across(si, sf, j, 1.0 / phi)
    if bent:
        at, touched, at_s = query(si, sf, cp, tree, stack, j, 0.0, ax, ay, before, winner, K_LOW)
        if touched >= 0:
            nx, ny, phi, winner, s = ax, ay, at, touched, at_s
    phi, winner, s = _past_corner(si, sf, cp, j, nx, ny, winner, s, phi)
    return OK, THROUGH, px + nx / phi, py + ny / phi, 1.0 / phi, winner, s


@inner
def joint_discs(si, sf, cp, tree, stack, tie, disc, kind, winner, winner_s, first, last):
    """`joint_disc` for the starts of sites first .. last - 1; returns (status, joint).

    What is known of the joint before is known of no joint before the first: parts may be worked on at a time.
    """
    hint = -1
    whole = -1
    for j in range(first, last):
        status, kind[j], x, y, r, winner[j], winner_s[j] = joint_disc(si, sf, cp, tree, stack, j, hint, tie, disc, whole)
        if kind[j] == ARC_CONTACT:
            whole = j
        disc[j, 0] = x
        disc[j, 1] = y
        disc[j, 2] = r
        if status != OK:
            return status, j
        if kind[j] == THROUGH:
            hint = winner[j]
    return OK, -1
