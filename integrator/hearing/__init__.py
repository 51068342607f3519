"""What the integrator's process hears, and when: the room's start, the viewers' reports."""
