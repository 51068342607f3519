"""Linux's own way: processes forked of a warm one, shared memory files, pipes, signals."""
