"""The views of an instant in, bodies out."""
