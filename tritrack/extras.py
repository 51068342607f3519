"""Optional packages of some commands, checked at their start, not after an hour's work."""

from importlib.util import find_spec


class ExtraMissing(RuntimeError):
    """A package that a command needs is not installed; the text says how to install it."""


def refuse_without(extra: str, *modules: str) -> None:
    """Refuse a command whose packages are missing.

    Args:
        extra: The extra that installs them.
        modules: Names in imports.

    Raises:
        ExtraMissing: When one is not installed.
    """
    missing = [name for name in modules if find_spec(name) is None]
    if missing:
        raise ExtraMissing(f"this needs {', '.join(missing)}: pip install 'tritrack[{extra}]'")
