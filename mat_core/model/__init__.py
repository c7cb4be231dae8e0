"""What a user hands in: rational B-spline edges, closed loops of them, and the rules a valid domain keeps."""
