"""The joints that one view's picture itself shows: by our network, by MediaPipe, or from files."""
