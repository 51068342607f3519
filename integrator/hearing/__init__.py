"""Input of the integrator's process: the room's start, the viewers' reports."""
