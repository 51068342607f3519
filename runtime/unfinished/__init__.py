"""Runs over long films: what is done lies on disk, and they go on where they were cut short."""
