"""Settings on the command line, which override those of a file."""

from pathlib import Path
from typing import Literal

import msgspec

from common.config.part_settings import SettingsError, SilhouetteSettings
from common.config.settings import LANDMARK_SOURCES, NETWORK, Settings
from common.method import Mode


def overridden(
    settings: Settings,
    mode: Mode | None,
    size: str | None,
    landmarks: str | None = None,
    offset_s: float | None = None,
    background: str | None = None,
    people: Literal["1", "all"] | None = None,
) -> Settings:
    """The settings with the command line's values; None keeps a setting.

    Raises:
        SettingsError: When the size is invalid, the source of landmarks is, or does not exist, or
            when there is neither a background nor landmarks.
    """
    try:
        named = msgspec.structs.replace(
            settings,
            mode=mode or settings.mode,
            size=size or settings.size,
            landmarks=settings.landmarks if landmarks is None else landmarks,
            silhouette=_silhouette(settings, background),
            offset_s=settings.offset_s if offset_s is None else offset_s,
            people=settings.people if people is None else (1 if people == "1" else "all"),
        )
    except ValueError as error:
        raise SettingsError(str(error)) from error
    if landmarks is not None:
        _refuse_absent(landmarks)
    return named


def _silhouette(settings: Settings, background: str | None) -> SilhouetteSettings:
    if background is None:
        return settings.silhouette
    if background != "none":
        raise SettingsError(f"background must be none, got {background!r}")
    return msgspec.structs.replace(settings.silhouette, background="none")


def _refuse_absent(landmarks: str) -> None:
    there = Path(landmarks).is_file() if landmarks.endswith(NETWORK) else Path(landmarks).is_dir()
    if landmarks not in LANDMARK_SOURCES and not there:
        raise SettingsError(
            f"there is no folder or network {landmarks} of landmarks: name a folder of keypoint "
            f"files, FILE{NETWORK}, or {', '.join(LANDMARK_SOURCES)}"
        )
