"""What the tracer sees of a domain: sites (pieces of monotone curvature and fans of normals) in flat tables."""
