"""The steps in lock-step, in one process."""
