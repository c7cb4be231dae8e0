"""From strips to curves: exact conics where both sides are lines, arcs or points, fitted polynomials elsewhere."""
