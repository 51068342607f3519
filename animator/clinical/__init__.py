"""Angles as clinics and OpenSim name them, and how far off they may be."""
