"""Training, evaluation and benchmarks: what a service never imports."""
