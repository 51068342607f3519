"""Poses and bodies fitted to both silhouettes."""
