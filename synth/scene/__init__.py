"""Scenes: several people in a room, their ways and what they do together."""
