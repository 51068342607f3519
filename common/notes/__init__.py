"""A user's annotations of a film: what a single view does not show (T21, T22)."""
