"""The live page: the room in three dimensions, and data about the body beside it."""
