"""Joints proposed by recurrent networks, from silhouettes and from landmarks."""
