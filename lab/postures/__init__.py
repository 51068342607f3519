"""Evaluation of posture recognition: the paper's experiment, and streams."""
