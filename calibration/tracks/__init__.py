"""What views show of the joints over time: tracks, sight lines, and by how much one is late."""
