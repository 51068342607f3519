"""What a command line sets above the settings of a file."""

import msgspec

from common.config.settings import Settings
from common.config.settings_error import SettingsError
from common.method import Mode


def overridden(
    settings: Settings, mode: Mode | None, size: str | None, landmarks: str | None = None
) -> Settings:
    """The settings with what a command line names instead; None leaves what they say.

    Raises:
        SettingsError: When the size is none, or the source of landmarks.
    """
    try:
        return msgspec.structs.replace(
            settings,
            mode=mode or settings.mode,
            size=size or settings.size,
            landmarks=settings.landmarks if landmarks is None else landmarks,
        )
    except ValueError as error:
        raise SettingsError(str(error)) from error
