"""What is seen of a run from outside: figures for Prometheus, and whether it is well."""
