"""One view alone: its silhouette lifted into the world (thesis 3.1.5)."""
