"""Linux's own means: processes forked of a warm one, shared memory files, pipes, signals."""
