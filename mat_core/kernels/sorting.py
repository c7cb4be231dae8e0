"""Sorting numbers 0 .. n - 1 by what belongs to them; equal ones stay as they were."""

from __future__ import annotations

from mat_core.kernels.jit import inner


@inner
def group(key, n, groups, start, order, before):
    """The first n of `before` to `order`, by their integer key; those of key g are order[start[g]:start[g + 1]].

    Keys are 0 .. groups - 1; start (groups + 1,).
    """
    for g in range(groups + 1):
        start[g] = 0
    for place in range(n):
        start[key[before[place]] + 1] += 1
    for g in range(groups):
        start[g + 1] += start[g]
    for place in range(n):
        c = before[place]
        order[start[key[c]]] = c
        start[key[c]] += 1
    # each start has become the next one
    for g in range(groups, 0, -1):
        start[g] = start[g - 1]
    start[0] = 0


@inner
def sort(key, order, spare, begin, end):
    """Sort order[begin:end] by key (merge sort); `spare`: room for as many."""
    width = 1
    while width < end - begin:
        for left in range(begin, end, 2 * width):
            middle = min(left + width, end)
            right = min(middle + width, end)
            a = left
            b = middle
            for place in range(left, right):
                if b >= right or (a < middle and key[order[a]] <= key[order[b]]):
                    spare[place] = order[a]
                    a += 1
                else:
                    spare[place] = order[b]
                    b += 1
        for place in range(begin, end):
            order[place] = spare[place]
        width *= 2
