"""How the shipped models are trained from synthetic people."""
