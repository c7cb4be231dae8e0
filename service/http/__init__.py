"""What is true of every request and answer, whatever its route: identity, keys, formats, caching, compression."""
