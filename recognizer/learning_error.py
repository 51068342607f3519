"""What keeps models from being learnt or tested: clips that are too few, or of the wrong people."""


class LearningError(ValueError):
    """Clips that no model can be learnt from or tested on; the text says why and what to give."""
