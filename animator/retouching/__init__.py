"""The retouching page: the user adds what one camera does not show, by pointer or keyboard."""
