"""Settings as 0.2 wrote them, in the words of this version: read for one version more."""

import warnings
from collections.abc import Mapping
from typing import Any, Final

import msgspec

from common.config.explained import explained
from common.config.part_settings import CameraSettings, SettingsError
from common.config.settings import Settings

CAMERAS: Final = {"camera_1": "cam1", "camera_2": "cam2"}
"""What 0.2 called its two cameras, and their names in `cameras`."""


class RenamedSetting(DeprecationWarning):
    """A setting in the words of an older version; the text says the new ones."""


def warn_of_renamed(written: object, where: str) -> None:
    """Say which tables of a settings file have another name now.

    Args:
        written: What the file holds, as plain values.
        where: What messages call it.
    """
    for old, name in CAMERAS.items():
        if isinstance(written, Mapping) and written.get(old) is not None:
            text = f"{where}: [{old}] is now [cameras.{name}]; 0.4 will not read the old name"
            warnings.warn(text, RenamedSetting, stacklevel=3)


def in_new_words(written: Any) -> Any:
    """Settings as plain values, with the names of this version; what is none is left as it is.

    Raises:
        SettingsError: When one camera is written in both ways.
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
    """The settings that a run was made with, of this version or the one before.

    Args:
        written: As plain values.

    Raises:
        ValidationError, SettingsError: When they are none.
    """
    new = in_new_words(written)
    cameras = new.get("cameras") if isinstance(new, Mapping) else None
    for name, camera in cameras.items() if isinstance(cameras, Mapping) else ():
        try:  # each by itself: what is wrong in a dict is told without its key
            msgspec.convert(camera, CameraSettings)
        except msgspec.ValidationError as error:
            raise SettingsError(f"cameras.{name}: {explained(error, CameraSettings)}") from error
    return msgspec.convert(new, Settings)
