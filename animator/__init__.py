"""A body in, a moving picture out."""
