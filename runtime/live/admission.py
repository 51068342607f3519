"""Checks of a live run before any of its processes starts."""

from typing import Final

import msgspec
from rich.console import Console

from common.config.settings import Settings
from common.method import METHODS
from common.video.clip_facts import Clip, whole_rig
from runtime.live.free_ports import own_session, refuse_held_ports, with_free_endpoint
from runtime.steps.method_cameras import (
    refuse_everyone_unmeasured,
    refuse_too_many,
    refuse_uncalibrated,
)
from runtime.store.recording import refuse_without_library

NO_POSTURE: Final = -1
"""posture_id of a clip that shows none of the postures: free motion, a test of tracking."""


class LiveRefused(ValueError):
    """A live run that cannot begin; the text names the cause and the cure."""


def admitted(settings: Settings, record: bool, console: Console) -> Settings:
    """Checked settings, with an open endpoint and session filled in.

    Args:
        settings: The run's settings.
        record: Whether it is recorded.
        console: Shows a chosen endpoint.

    Raises:
        LiveRefused, RecordingError, PortHeld, PageError, KeysError: When a check fails.
    """
    refuse_mode(settings)
    if record:
        refuse_without_library()
    found = with_free_endpoint(settings)
    refuse_held_ports(found)
    if found != settings:
        console.print(f"the bus: {found.bus.endpoint}", highlight=False)
    return own_session(found)


def opened(settings: Settings, name: str) -> Clip:
    """The clip of a run that passed all checks possible before it starts.

    Its imports take a second, during which the page opens.

    Args:
        settings: The run's settings.
        name: Name of the run; the clip's where empty.

    Raises:
        ClipError, LiveRefused, ModelError, SettingsError: When a process would fail.
    """
    from common.video.clips import open_clip
    from runtime.offline.lockstep import measured_before

    clip = open_clip(settings)
    refuse_too_many(clip, METHODS[settings.mode])
    refuse_uncalibrated(clip)
    refuse_everyone_unmeasured(clip, settings)
    clip = msgspec.structs.replace(
        clip,
        name=name or clip.name,
        rig=whole_rig(clip),
        body=measured_before(settings),
    )
    _refuse_what_would_fail(settings, clip)
    return clip


def _refuse_what_would_fail(settings: Settings, clip: Clip) -> None:
    """Raise any error that a process would meet, before one starts."""
    from recognizer.__main__ import model_of
    from viewer.landmarks.landmark_sources import refuse_landmarks

    meant = "" if clip.meta.posture_id == NO_POSTURE else clip.meta.posture
    model_of(settings, meant)
    refuse_landmarks(settings, clip.views)


def refuse_mode(settings: Settings) -> None:
    """Refuse the thesis's mode, which has no processes.

    Raises:
        LiveRefused: When it is requested.
    """
    if METHODS[settings.mode].stick_lifting:
        raise LiveRefused(
            "the thesis's mode is not for live runs: set mode = 'default' or 'paper', or follow "
            "a recorded video with: tritrack single VIDEO --mode thesis"
        )
