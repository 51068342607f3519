"""The settings of a program's own loop."""

from typing import Literal

import msgspec

from common.config.part_settings import BodySettings, SettingsError, SilhouetteSettings
from common.config.settings import Settings
from common.method import Mode
from runtime.steps.loop_images import Images

People = Literal[1, "all"]


def kind_of(background: Images | Literal["none"] | None) -> Literal["learnt", "none"]:
    """How people are distinguished from the background.

    Raises:
        SettingsError: When it is another word.
    """
    if not isinstance(background, str):
        return "learnt"
    if background != "none":
        raise SettingsError(f'background must be images, "none" or None, got {background!r}')
    return background


def settings_of(
    size: str,
    mode: Mode,
    landmarks: str,
    people: People,
    stature_m: float,
    silhouette: SilhouetteSettings,
) -> Settings:
    """The settings.

    Raises:
        SettingsError: When one of them is out of bounds, or not supported in a loop.
    """
    if mode not in ("default", "paper"):
        raise SettingsError(f"mode must be default or paper in a loop of one's own, got {mode!r}")
    if landmarks not in ("own", "none"):
        raise SettingsError(f"landmarks must be own or none, got {landmarks!r}")
    if people not in (1, "all"):
        raise SettingsError(f'people must be 1 or "all", got {people!r}')
    try:
        body = BodySettings(stature_m=float(stature_m))
        named = Settings(size=str(size), mode=mode, landmarks=landmarks, people=people, body=body)
        return msgspec.structs.replace(named, silhouette=silhouette)
    except ValueError as error:
        raise SettingsError(str(error)) from error
