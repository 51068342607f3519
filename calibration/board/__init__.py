"""Calibration with a printed board: its corners, the rig that they give, the floor, the
coverage."""
