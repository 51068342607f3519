"""What parts of a run import, compile and load before their first frames."""
