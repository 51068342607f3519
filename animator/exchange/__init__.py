"""Motion files for programs that do not read BVH."""


class LibraryMissing(RuntimeError):
    """A format whose library is not installed; the text says how to install it."""
