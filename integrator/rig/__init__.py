"""Where the cameras are, and where a body is in the world that they see (section 4.1)."""
