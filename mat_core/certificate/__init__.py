"""The judge: checks an axis against its boundary, sharing no code with what found it."""

from mat_core.certificate.certify import certify

__all__ = ["certify"]
