"""The body's lengths: unknown, a prior by silhouettes, or measured in the opening posture."""
