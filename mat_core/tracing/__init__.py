"""Points of the axis inside a strip, footpoint by footpoint."""
