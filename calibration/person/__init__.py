"""Two cameras calibrated by the person who moves before them: nothing is measured or printed."""
