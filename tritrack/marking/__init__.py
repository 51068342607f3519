"""Markers and poles clicked on a page instead of typed."""
