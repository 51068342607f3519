"""How well postures are named: the paper's experiment, and streams."""
