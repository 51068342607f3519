"""Several rooms on one machine: sites started, watched over, changed and ended."""
