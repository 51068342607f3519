"""Files of motion for other programs than those that read BVH."""
