"""Calibration of two cameras by a moving person: nothing is measured or printed."""
