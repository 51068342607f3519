"""A run as seen from outside: metrics for Prometheus, and its health."""
