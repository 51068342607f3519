"""The same steps in one process, in lock-step."""
