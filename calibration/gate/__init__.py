"""Is a given rig believable by what both views show, and what is likeliest wrong with it."""
