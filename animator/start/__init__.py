"""The start page for browsers: its server, its messages, its site."""
