"""Polynomials in Bernstein form: products, values, isolated sign changes.

A row of a scratch table holds one polynomial, either as Bernstein coefficients c_i or *scaled* (c_i times binomial(n, i)),
where a product is a plain convolution.
"""

from __future__ import annotations

from mat_core.kernels.jit import inner

MAX_DEPTH = 44  # halvings of [0, 1] before a cluster of sign changes is taken as one
NOISE = 1e-15  # coefficients below this share of the largest carry no sign


@inner
def scale_row(table, row, n, to_scaled):
    """Multiply (or divide) the n + 1 coefficients of a row by the binomials of degree n."""
    binomial = 1.0
    for i in range(n + 1):
        if to_scaled:
            table[row, i] *= binomial
        else:
            table[row, i] /= binomial
        binomial = binomial * (n - i) / (i + 1.0)


@inner
def add_product(table, a, na, b, nb, out, factor):
    """out += factor * a * b for scaled rows of degrees na, nb (out of degree na + nb)."""
    for i in range(na + 1):
        c = factor * table[a, i]
        if c != 0.0:
            for j in range(nb + 1):
                table[out, i + j] += c * table[b, j]


@inner
def restrict_row(table, row, n, a, b):
    """Bernstein coefficients over [a, b] instead of [0, 1], 0 <= a < b <= 1, by convex steps."""
    if b < 1.0:
        for level in range(1, n + 1):
            for i in range(n, level - 1, -1):
                table[row, i] = (1.0 - b) * table[row, i - 1] + b * table[row, i]
    if a > 0.0:
        share = a / b
        for level in range(1, n + 1):
            for i in range(n - level + 1):
                table[row, i] = (1.0 - share) * table[row, i] + share * table[row, i + 1]


@inner
def clear_row(table, row, n):
    """Set the n + 1 coefficients of a row to zero."""
    for i in range(n + 1):
        table[row, i] = 0.0


@inner
def _value(work, row, n, s):
    """Value at s of the polynomial in a row of Bernstein coefficients, by Horner's scheme on the ratio."""
    t = 1.0 - s
    low = s <= 0.5
    ratio = s / t if low else t / s
    c = t**n if low else s**n
    total = 0.0
    for step in range(n + 1):
        i = step if low else n - step
        total += c * work[row, i]
        c *= ratio * (n - step) / (step + 1.0)
    return total


@inner
def _halve(work, row, n):
    """De Casteljau at 1/2: the left half stays in `row`, the right half goes to `row + 1`."""
    for i in range(n + 1):
        work[row + 1, i] = work[row, i]
    for level in range(1, n + 1):
        # work[row + 1, 0 .. n-level] holds the level's points; its first one belongs to the left half
        for i in range(n + 1 - level):
            work[row + 1, i] = 0.5 * (work[row + 1, i] + work[row + 1, i + 1])
        work[row, level] = work[row + 1, 0]


@inner
def _noise(row_of, row, n):
    """What a coefficient must exceed to carry a sign."""
    largest = 0.0
    for i in range(n + 1):
        largest = max(largest, abs(row_of[row, i]))
    return NOISE * largest


@inner
def _outermost_sign(work, row, n, noise, from_end):
    """Sign of the first (or last) coefficient that stands out of the noise; 0 if none does."""
    for step in range(n + 1):
        i = n - step if from_end else step
        if abs(work[row, i]) > noise:
            return 1.0 if work[row, i] > 0.0 else -1.0
    return 0.0


@inner
def first_sign(poly, row, n):
    """Sign of a polynomial right behind 0; 0 if all of it is noise."""
    return _outermost_sign(poly, row, n, _noise(poly, row, n), False)


@inner
def last_sign(poly, row, n):
    """Sign of a polynomial right before 1; 0 if all of it is noise."""
    return _outermost_sign(poly, row, n, _noise(poly, row, n), True)


@inner
def sign_changes(poly, row, n, work, bounds, roots, count):
    """Write where the polynomial (Bernstein coefficients in `poly[row]`) changes sign in (0, 1); returns the new `count`.

    Descartes' rule on halved intervals; a cluster that does not separate counts as one. `work` (MAX_DEPTH + 2, n + 1) and
    `bounds` (MAX_DEPTH + 2, 2) are scratch; roots come in increasing order.
    """
    for i in range(n + 1):
        work[0, i] = poly[row, i]
    noise = _noise(work, 0, n)
    first = count
    bounds[0, 0] = 0.0
    bounds[0, 1] = 1.0
    top = 0
    while top >= 0:
        variations = 0
        last = 0.0
        start_sign = _outermost_sign(work, top, n, noise, False)
        for i in range(n + 1):
            c = work[top, i]
            if abs(c) > noise:
                if last * c < 0.0:
                    variations += 1
                last = 1.0 if c > 0.0 else -1.0
        a = bounds[top, 0]
        b = bounds[top, 1]
        if variations == 0:
            top -= 1
            continue
        if variations == 1 or top >= MAX_DEPTH or b - a < 1e-13:
            if variations % 2 == 1 and count < roots.shape[0]:
                lo = 0.0
                hi = 1.0
                for _ in range(54):
                    mid = 0.5 * (lo + hi)
                    if _value(work, top, n, mid) * start_sign > 0.0:
                        lo = mid
                    else:
                        hi = mid
                roots[count] = a + 0.5 * (lo + hi) * (b - a)
                count += 1
            top -= 1
            continue
        # the right half is left on the stack, the left half is done first
        _halve(work, top, n)
        for i in range(n + 1):
            left = work[top, i]
            work[top, i] = work[top + 1, i]
            work[top + 1, i] = left
        m = 0.5 * (a + b)
        if abs(work[top, 0]) <= noise and count < roots.shape[0] and _outermost_sign(
                work, top + 1, n, noise, True) * _outermost_sign(work, top, n, noise, False) < 0.0:
            # neither half sees a change that lies at their common end
            roots[count] = m
            count += 1
        bounds[top, 0] = m
        bounds[top, 1] = b
        top += 1
        bounds[top, 0] = a
        bounds[top, 1] = m
    for i in range(first + 1, count):
        value = roots[i]
        j = i
        while j > first and roots[j - 1] > value:
            roots[j] = roots[j - 1]
            j -= 1
        roots[j] = value
    return count
