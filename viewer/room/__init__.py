"""What a view shows without people: which of several backgrounds explains what is seen."""
