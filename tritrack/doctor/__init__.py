"""What is missing, here and for a run, and what to do about it."""
