"""Settings as version 0.2 named them, accepted for one more version."""

import warnings
from collections.abc import Mapping
from typing import Any, Final

import msgspec

from common.config.explained import explained
from common.config.part_settings import CameraSettings, SettingsError
from common.config.settings import Settings

CAMERAS: Final = {"camera_1": "cam1", "camera_2": "cam2"}
"""Version 0.2's tables of its two cameras, and their names in `cameras`."""


class RenamedSetting(DeprecationWarning):
    """A setting under an older name; the text gives the new one."""


def warn_of_renamed(written: object, where: str) -> None:
    """Warn about renamed tables in a settings file.

    Args:
        written: The file's content, as plain values.
        where: How messages name the file.
    """
    for old, name in CAMERAS.items():
        if isinstance(written, Mapping) and written.get(old) is not None:
            text = f"{where}: [{old}] is now [cameras.{name}]; 0.4 will not read the old name"
            warnings.warn(text, RenamedSetting, stacklevel=3)


def in_new_words(written: Any) -> Any:
    """Settings as plain values, renamed to this version; what is no table is returned as it is.

    Raises:
        SettingsError: When one camera is given under both names.
    """
    if not isinstance(written, Mapping) or not written.keys() & CAMERAS.keys():
        return written
    new = {key: value for key, value in written.items() if key not in CAMERAS}
    cameras = new.get("cameras", {})
    if not isinstance(cameras, Mapping):
        return new
    old = {name: written[key] for key, name in CAMERAS.items() if written.get(key) is not None}
    for key, name in CAMERAS.items():
        if name in old and name in cameras:
            raise SettingsError(f"[{key}] and [cameras.{name}] are one camera: remove [{key}]")
    return {**new, "cameras": {**old, **cameras}}


def settings_of(written: object) -> Settings:
    """The settings of a run, written by this version or the one before.

    Args:
        written: The settings as plain values.

    Raises:
        ValidationError, SettingsError: When they are invalid.
    """
    new = in_new_words(written)
    cameras = new.get("cameras") if isinstance(new, Mapping) else None
    for name, camera in cameras.items() if isinstance(cameras, Mapping) else ():
        try:  # each by itself: a fault inside a dict is reported without its key
            msgspec.convert(camera, CameraSettings)
        except msgspec.ValidationError as error:
            raise SettingsError(f"cameras.{name}: {explained(error, CameraSettings)}") from error
    return msgspec.convert(new, Settings)
