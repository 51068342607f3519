"""Calibrations of other programs, read and written with their conventions."""
