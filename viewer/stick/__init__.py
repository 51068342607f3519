"""The stick body of one camera: the thesis's algorithms 1 to 6, and a tracking search."""
