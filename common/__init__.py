"""What all parts share: the body, its picture, messages, the bus, settings."""
