"""Cut the boundary at all contacts; the contacts of the discs tie the arcs between them to faces.

          arc a              The domain cut along its discs falls apart into faces. A face is a cycle
      D ----------- D'       a, next(a), ... of contact arcs; between two of them lies one disc:
        \\   face   /            next(arc ending at q[i+1]) = arc starting at q[i]
         arc next(a)         for the contacts q of that disc, anticlockwise around its centre.

A face of one arc is an arc in whole contact with its disc, of two a strip (one stretch of the axis), of three a branch point, of
more a small tree. Euler: faces = 1 - holes + sum over discs of (contacts - 1).
"""

from __future__ import annotations

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import LOOP
from mat_core.kernels.sorting import group, sort
from mat_core.topology.rooms import AROUND, AROUND_START, DISC_OF, FACE_ARCS, NEXT_ARC, PLACE_AROUND, SITE_OF


@inner
def cut_arcs(si, site, s, n, arc_hi, next_contact):
    """Arcs between consecutive ones of n contacts in loop order: arc a starts at contact a and ends at contact next_contact[a].

    All joints are contacts, so an arc lies on the site it starts on: it runs from s of its first contact to `arc_hi[a]`.
    """
    first = 0
    for a in range(n):
        last_of_loop = a + 1 == n or si[site[a + 1], LOOP] != si[site[a], LOOP]
        following = first if last_of_loop else a + 1
        next_contact[a] = following
        arc_hi[a] = s[following] if site[following] == site[a] and following > a else 1.0
        if last_of_loop:
            first = a + 1


@inner
def link_arcs(n, next_contact, around, around_start, disc_of, place_around, next_arc):
    """next_arc[a]: the arc that follows arc a, of n, around its face.

    `around[around_start[d]:around_start[d+1]]`: contacts of disc d, anticlockwise; `place_around[c]`: where c stands there.
    """
    for a in range(n):
        e = next_contact[a]
        d = disc_of[e]
        place = place_around[e]
        previous = place - 1 if place > around_start[d] else around_start[d + 1] - 1
        next_arc[a] = around[previous]


@inner
def list_faces(n, next_arc, face_arcs, face_start):
    """Cycles of the first n of `next_arc`, one after the other in `face_arcs`; returns their number."""
    done = 0
    faces = 0
    for a in range(n):
        face_start[faces] = done
        b = a
        while next_arc[b] >= 0:
            face_arcs[done] = b
            done += 1
            after = next_arc[b]
            next_arc[b] = -1
            b = after
        if done > face_start[faces]:
            faces += 1
    face_start[faces] = done
    return faces


@inner
def link_faces(found, links, room, discs, contacts):
    """Put the faces in `room`; how many."""
    around_start = links[AROUND_START]
    around = links[AROUND]
    place_around = links[PLACE_AROUND]
    face_arcs = links[FACE_ARCS]
    owner = found.owner
    for c in range(contacts):
        face_arcs[c] = c
    group(owner, contacts, discs, around_start, around, face_arcs)
    for d in range(discs):
        sort(found.angle, around, face_arcs, around_start[d], around_start[d + 1])
    for place in range(contacts):
        place_around[around[place]] = place
    link_arcs(contacts, found.next_contact, around, around_start, owner, place_around, links[NEXT_ARC])
    faces = list_faces(contacts, links[NEXT_ARC], face_arcs, room.face_start)
    for place in range(contacts):
        a = face_arcs[place]
        room.stack_i[place, 0] = found.site[a]
        room.stack_i[place, 1] = owner[found.next_contact[a]]
        room.stack_f[place, 0] = found.s[a]
        room.stack_f[place, 1] = found.arc_hi[a]
        room.contact_i[DISC_OF, place] = owner[place]
        room.contact_i[SITE_OF, place] = found.site[place]
        room.contact_s[place] = found.s[place]
    return faces
