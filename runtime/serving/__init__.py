"""Several rooms on one machine: sites started, monitored, changed and ended."""
