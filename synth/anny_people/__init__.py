"""People of the Anny body model, with skin and muscles, to teach beside our own."""
