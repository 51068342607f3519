"""Bridges: a live run's messages in the protocols of other programs."""
