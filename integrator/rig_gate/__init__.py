"""Whether a rig that is given is believable, and what is likeliest wrong with it."""
