"""A body measured before a run, from a separate clip of the person in a T pose."""

from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from common.body.body import Bdp
from common.bus.messages import Body
from common.config import config_file
from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.video.clip_sources import ClipError


def body_of(settings: Settings, track: Callable[[Settings], Sequence[Body]]) -> Bdp | None:
    """The person's lengths, metres, from the opening clip; None without one.

    Args:
        settings: The run's; mode and size hold for the opening clip too.
        track: Tracks a clip.

    Raises:
        SettingsError: When the opening clip's own settings name another one, or cannot be read.
        ClipError: When it shows no person, or cannot be used.
    """
    if not settings.opening:
        return None
    try:
        own = config_file.load(Path(settings.opening))
    except SettingsError as error:
        raise SettingsError(f"opening = {settings.opening!r}: {error}") from error
    if own.opening:
        raise SettingsError(f"{settings.opening}: an opening clip has none itself: remove opening")
    own = msgspec.structs.replace(own, mode=settings.mode, size=settings.size)
    lengths = [body.bdp for body in track(own) if body.bdp is not None]
    if not lengths:
        raise ClipError(f"nobody is seen in the opening clip {settings.opening}: name another")
    return lengths[-1]
