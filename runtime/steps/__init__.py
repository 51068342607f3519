"""The steps of one instant: for a clip in lock-step, and for a loop of one's own."""
