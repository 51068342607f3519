"""Whether a given rig is believable by what both views show, and its likeliest fault."""
