"""Imports, compilation and loading of a run's parts before their first frames."""
