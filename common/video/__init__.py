"""Clips and what decodes them, in a process that may die."""
