"""The live page: the room in three dimensions, and beside it what is known of the body."""
