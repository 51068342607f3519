"""What the pictures themselves show of the joints, made one with what the outlines propose."""
