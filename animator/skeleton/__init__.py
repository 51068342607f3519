"""A skeleton of fixed bones for a run, with feet that do not slide."""
