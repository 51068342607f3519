"""Training of posture models."""
