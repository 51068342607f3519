"""A run to look at: the overlay of its views, its report, and two runs compared."""
