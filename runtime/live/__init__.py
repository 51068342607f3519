"""Live runs: the table of processes, their supervision, their records."""
