"""The HTTP skin of mat_core: one POST, its documentation, and the processes that do the computing.

The web process (`service.app`) reads bytes and forwards them; it never imports mat_core. The workers
(`service.solve`, forked by `service.nursery`) parse, solve and encode; they never import the web framework.
`service.pool` stands between.
"""

__version__ = "0.1.0"
