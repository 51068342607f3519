"""What is asked of the operating system, and who answers: Linux's own way, or Python's alone."""
