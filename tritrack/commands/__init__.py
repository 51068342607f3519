"""The commands, by group: what a user types, and what is answered."""
