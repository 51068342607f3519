"""Run folders: how they are named, written and read again."""
