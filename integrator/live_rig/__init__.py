"""Rigs by the person while a run goes on: gathered from its reports, found beside its frames."""
