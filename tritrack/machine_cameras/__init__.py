"""The cameras of this machine: which there are, what they show, the settings to track with them."""
