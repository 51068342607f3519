"""Calibrations of other programs, read and written in their conventions."""
