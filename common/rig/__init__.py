"""Cameras and the file that describes them."""
