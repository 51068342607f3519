"""Settings files: TOML that overrides the defaults, with paths relative to the file."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

import msgspec

from common.config.explained import explained
from common.config.part_settings import SettingsError
from common.config.renamed_settings import settings_of, warn_of_renamed
from common.config.settings import LANDMARK_SOURCES, NETWORK, Settings

MOST_BYTES: Final = 1 << 20
"""Upper bound of a settings file's size, bytes: a larger file is probably a video, and is not
read."""


def load(path: Path) -> Settings:
    """Read a settings file; a clip folder counts as one that sets the clip alone.

    Relative paths in the file are relative to the file.

    Raises:
        SettingsError: When the file cannot be read, holds an unknown or ill-typed setting, or names
            a landmarks folder that does not exist.
    """
    if path.is_dir():
        return Settings(clip=str(path))
    if not path.exists():
        raise SettingsError(f"there is no clip folder and no settings file {path}: check the path")
    try:
        with path.open("rb") as file:
            text = file.read(MOST_BYTES)
    except OSError as error:
        raise SettingsError(f"cannot read the settings {path}: {error.strerror}") from error
    try:
        written = msgspec.toml.decode(text)
        warn_of_renamed(written, str(path))
        settings = settings_of(written)
    except (UnicodeDecodeError, msgspec.DecodeError) as error:
        if isinstance(error, UnicodeDecodeError) or b"\0" in text:
            raise SettingsError(
                f"{path} is no settings file: name a TOML file, or the folder that holds cam1.* "
                f"and cam2.*; of one video: tritrack single {path}"
            ) from error
        raise SettingsError(f"{path}: {explained(error, Settings)}") from error
    except SettingsError as error:
        raise SettingsError(f"{path}: {error}") from error
    return with_full_paths(settings, path)


def with_full_paths(settings: Settings, path: Path) -> Settings:
    """Settings with relative paths resolved against the file's folder and environment variables
    replaced.

    Raises:
        SettingsError: When a variable is not set, or the landmarks do not exist.
    """
    found = msgspec.structs.replace(settings, landmarks=_landmarks(settings.landmarks, path))
    return _with_paths(found, lambda name: full_path(name, path))


def with_absolute_paths(settings: Settings) -> Settings:
    """Settings whose paths mean the same in any present folder, as those that a run keeps."""

    def absolute(name: str) -> str:
        return str(Path(name).absolute()) if name else ""

    own = settings.landmarks
    found = own if own in LANDMARK_SOURCES else absolute(own)
    return _with_paths(msgspec.structs.replace(settings, landmarks=found), absolute)


def _with_paths(settings: Settings, full: Callable[[str], str]) -> Settings:
    """Settings with each path but that of landmarks replaced by what `full` makes of it."""
    cameras = {
        name: msgspec.structs.replace(
            each, source=full(each.source), background=full(each.background)
        )
        for name, each in settings.cameras.items()
    }
    recognizer, bus = settings.recognizer, settings.bus
    return msgspec.structs.replace(
        settings,
        clip=full(settings.clip),
        calibration=full(settings.calibration),
        opening=full(settings.opening),
        cameras=cameras,
        recognizer=msgspec.structs.replace(recognizer, model=full(recognizer.model)),
        bus=msgspec.structs.replace(bus, keys=full(bus.keys)),
    )


def full_path(name: str, path: Path) -> str:
    """A path of the file, resolved against its folder, with variables replaced; "" stays "".

    Where there is a file or folder of just that name, its signs are no variables.

    Raises:
        SettingsError: When a variable is not set.
    """
    if "$" in name and (path.parent / name).exists():
        return str(path.parent / name)
    filled = os.path.expandvars(name)
    if "$" in filled:
        raise SettingsError(f"{path}: {name} names a variable that is not set: export it")
    return str(path.parent / filled) if name else ""


def _landmarks(given: str, path: Path) -> str:
    if given in LANDMARK_SOURCES:
        return given
    source = full_path(given, path)
    is_network = given.endswith(NETWORK)
    if not (Path(source).is_file() if is_network else Path(source).is_dir()):
        known = ", ".join(LANDMARK_SOURCES)
        kind = "network" if is_network else "folder"
        raise SettingsError(
            f"{path}: there is no {kind} {source} of landmarks: write its path, or {known}"
        )
    return source
