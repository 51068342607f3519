"""Section 4.1 of the paper: line markers and poles."""
