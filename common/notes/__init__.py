"""A user's annotations of a video: what a single view does not show (T21, T22)."""
