"""Rigs from the person during a run: gathered from its reports, computed beside its frames."""
