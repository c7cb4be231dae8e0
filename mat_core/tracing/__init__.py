"""Points of the axis, footpoint by footpoint: inside a strip, beside a fitted curve, and in the paper's own march."""
