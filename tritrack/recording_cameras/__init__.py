"""Cameras recorded into a clip folder: `tritrack record`."""
