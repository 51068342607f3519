"""Cameras by a printed board: its corners, the rig that they tell, the floor, the coverage."""
