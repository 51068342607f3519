"""What no settings could mean: the refusal, and the bounds of numbers."""


class SettingsError(ValueError):
    """Settings that no run could mean: the text names the file, the place and the cure."""


def within(name: str, value: float, low: float, high: float) -> None:
    """Refuse a number out of bounds.

    Raises:
        ValueError: It names what was got.
    """
    if not low <= value <= high:
        raise ValueError(f"{name} must be from {low} to {high}, got {value}")
