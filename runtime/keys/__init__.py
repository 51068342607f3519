"""Keys of a bus: made, and looked over."""
