"""The landmarks of the pictures, fused with the silhouettes' proposal."""
