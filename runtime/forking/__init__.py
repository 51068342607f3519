"""Processes that are forked of a warm one, and whose children they become."""
