"""Accuracy of tracking, on clips with ground truth."""
