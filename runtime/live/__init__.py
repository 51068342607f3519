"""Live runs: the table of processes, their supervision, what is recorded."""
