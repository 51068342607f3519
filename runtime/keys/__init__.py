"""The keys of a bus: how they are made and checked."""
