"""Bridges: what a live run says, in the protocols of other programs."""
