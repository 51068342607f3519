"""Checks of the installation and of a run's needs, with cures."""
