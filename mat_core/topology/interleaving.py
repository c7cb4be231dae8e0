"""Contacts of two nearly equal discs around their common centre: where they alternate, both cannot be maximal.

Contacts of each disc are linked lists: `first` of a disc, `member_next` of a contact.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import LOOP

GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # turns by it come near each other late
CUTS = 16  # directions tried
ANGLE_NEAR = 1e-5  # contacts nearer than this around a centre are ordered along the boundary, not by angle


@inner
def contact_angle(si, sf, cp, disc, d, i, s):
    """Direction from the centre of disc d to its contact at s on site i."""
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    return math.atan2(py - disc[d, 1], px - disc[d, 0])


@inner
def _before(si, loop_start, site_a, s_a, angle_a, site_b, s_b, angle_b):
    """Whether contact a comes before b anticlockwise, from a cut of the circle that both are away from.

    Along the boundary where angles do not tell: there the last site of a loop comes before its first one.
    """
    if abs(angle_a - angle_b) >= ANGLE_NEAR:
        return angle_a < angle_b
    before = site_a < site_b or (site_a == site_b and s_a < s_b)
    loop = si[site_a, LOOP]
    if loop == si[site_b, LOOP] and 2.0 * abs(site_a + s_a - site_b - s_b) > loop_start[loop + 1] - loop_start[loop]:
        return not before
    return before


@inner
def _nearest_contact(angle, member_next, c, cut):
    """Angle between a direction and the contact nearest to it in the list that begins with contact c."""
    nearest = math.pi
    while c >= 0:
        nearest = min(nearest, abs((angle[c] - cut + math.pi) % (2.0 * math.pi) - math.pi))
        c = member_next[c]
    return nearest


@inner
def interleaved(si, loop_start, site, s, angle, member_next, first, a, b):
    """Whether the contacts of groups a and b alternate around their common centre.

    Groups are linked lists (`first`, `member_next`) of contacts. No contact may lie near where the circle is cut: between
    parallel walls some are opposite to others.
    """
    cut = angle[first[a]]
    for _ in range(CUTS):
        cut += GOLDEN
        nearest = min(_nearest_contact(angle, member_next, first[a], cut), _nearest_contact(angle, member_next, first[b], cut))
        if nearest > 2.0 * ANGLE_NEAR:
            break
    gap = -1
    cb = first[b]
    while cb >= 0:
        below = 0
        ca = first[a]
        total = 0
        while ca >= 0:
            if _before(si, loop_start, site[ca], s[ca], (angle[ca] - cut) % (2.0 * math.pi),
                       site[cb], s[cb], (angle[cb] - cut) % (2.0 * math.pi)):
                below += 1
            total += 1
            ca = member_next[ca]
        if below == total:
            below = 0
        if gap < 0:
            gap = below
        elif gap != below:
            return True
        cb = member_next[cb]
    return False
