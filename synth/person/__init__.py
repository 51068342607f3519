"""Synthetic people: proportions, skeletons, skinned bodies, clothes."""
