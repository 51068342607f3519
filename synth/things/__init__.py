"""Things in rooms: furniture, textures, pictures that move, and what hides people in pictures."""
