"""Where the cameras are, and whether that can be believed."""
