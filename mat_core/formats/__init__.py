"""Ways out: the answer document as JSON, the axis as a picture."""
