"""Camera calibration, and tests of whether a calibration is believable."""
