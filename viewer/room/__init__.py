"""What a view shows, held against its landmarks: the room without people, and the silhouette."""
