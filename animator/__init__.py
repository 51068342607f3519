"""Drawings of a body: the live page, overlays and files of motion."""
