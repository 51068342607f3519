"""People of the Anny body model, with skin and muscles, as additional training data."""
