"""What people do with a medial axis: offset, measure, find, prune, rebuild.

Each function takes a `MedialAxis` and gives a frozen result with `to_dict()`; an argument out of its range raises
`UnsupportedOption` that names it. Lengths are in the caller's unit.
"""
