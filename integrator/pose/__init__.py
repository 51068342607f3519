"""Poses of joints: inverse kinematics, limits, smoothing."""
