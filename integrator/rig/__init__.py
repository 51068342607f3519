"""Where the cameras stand, and where in the world a body is that they see (section 4.1)."""
