"""A skeleton of fixed bones through a run, and feet that stand still in it."""
