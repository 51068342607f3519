"""The platforms by name, and the one that this process uses."""

import os
from functools import cache
from importlib import import_module
from typing import Final

from common.config.part_settings import SettingsError
from common.platform.platform import Platform

CHOICE: Final = "TRITRACK_PLATFORM"
"""Environment variable that names a platform; a run's processes inherit it."""
PLATFORMS: Final = {
    "linux": f"{__package__}.linux.linux_platform",
    "portable": f"{__package__}.portable",
}
"""Modules with a PLATFORM, best first; one that this system lacks cannot be imported."""


@cache
def platform() -> Platform:
    """The platform that TRITRACK_PLATFORM names, else the first that this system has.

    Raises:
        SettingsError: When there is none of that name, or this system lacks its requirements.
    """
    asked = os.environ.get(CHOICE, "")
    if asked and asked not in PLATFORMS:
        raise SettingsError(f"{CHOICE}={asked}: it is one of {', '.join(PLATFORMS)}, or not set")
    missing = ""
    for name in [asked] if asked else PLATFORMS:
        try:
            found: Platform = import_module(PLATFORMS[name]).PLATFORM
        except ImportError as error:
            missing = str(error)
        else:
            return found
    raise SettingsError(f"{CHOICE}={asked}: this system lacks what that needs: {missing}")
