"""What pages say in pieces of HTML, from templates beside the code."""

from collections.abc import Mapping
from typing import Any, Final

from animator.scene import Colour
from common.templates import rendered

ACCENT: Final[Colour] = (62, 142, 126)


def piece(name: str, given: Mapping[str, Any]) -> str:
    """A template of a page filled in."""
    return rendered(__package__, name, given)
