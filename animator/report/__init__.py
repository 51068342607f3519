"""What a run shows, as a page: curves, belief, cycles, worst frames, and two runs compared."""
