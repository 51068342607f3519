"""How models of postures are trained."""
