"""Training of the packaged models on synthetic people."""
