"""Files of motion for other programs than those that read BVH."""


class LibraryMissing(RuntimeError):
    """A format whose library is not installed; the text says how to get it."""
