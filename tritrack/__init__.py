"""The front door: the commands and the processes that they start."""
