"""A body's angles in, a posture's name out."""
