"""The retouching page: what one camera does not show is said there, by pointer or by keyboard."""
