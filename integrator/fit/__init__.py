"""Fits of poses and bodies to both silhouettes."""
