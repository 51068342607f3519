"""The marking page: points of a calibration clicked in the cameras' pictures."""
