"""Things that hide people in pictures."""
