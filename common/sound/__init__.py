"""What a video sounds like, and how late one sound is against another."""
