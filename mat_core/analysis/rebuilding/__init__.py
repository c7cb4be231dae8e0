"""The boundary rebuilt from axis and radius: envelopes of discs, closed and compared with what was given."""
