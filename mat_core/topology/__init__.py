"""Where the axis branches, before a single point of it is sampled: discs, faces, branch points, graph."""
