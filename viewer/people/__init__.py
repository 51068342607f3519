"""People in a picture: where they are, and who is who over time."""
