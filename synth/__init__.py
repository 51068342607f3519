"""Clips whose truth is known."""
