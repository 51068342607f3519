"""What only some commands need: asked for at their start, not after an hour's work."""

from importlib.util import find_spec


class ExtraMissing(RuntimeError):
    """A package that a command needs is not installed; the text says how it is."""


def refuse_without(extra: str, *modules: str) -> None:
    """Say what a command lacks.

    Args:
        extra: Which brings it.
        modules: As imports name them.

    Raises:
        ExtraMissing: When one is not installed.
    """
    missing = [name for name in modules if find_spec(name) is None]
    if missing:
        raise ExtraMissing(f"this needs {', '.join(missing)}: pip install 'tritrack[{extra}]'")
