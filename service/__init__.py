"""The HTTP skin of mat_core: a POST for the axis and one for each analysis, documentation, and processes that compute.

The web process (`service.app`) reads bytes and forwards them; it never imports mat_core. The workers
(`service.workers.solve`, forked by `service.workers.nursery`) parse, solve and encode; they never import the web framework.
`service.workers.pool` stands between.
"""

from pathlib import Path

# One number for both packages, in the library's folder; read without importing the library.
__version__ = (Path(__file__).parents[1] / "mat_core" / "VERSION").read_text(encoding="ascii").strip()
