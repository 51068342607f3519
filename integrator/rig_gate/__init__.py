"""Whether a rig that is given is believable by what both views show, and what is likeliest wrong."""
