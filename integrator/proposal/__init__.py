"""The joints that a recurrent network proposes from the silhouettes."""
