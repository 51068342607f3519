"""Two reports (or one) in, one body out."""
