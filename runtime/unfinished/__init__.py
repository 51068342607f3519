"""Runs over long videos: intermediate results on disk, from which an interrupted run resumes."""
