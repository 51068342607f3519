"""The front door: the commands, and the public API for programs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final
from warnings import warn

from common import __name__ as COMMON
from runtime import __name__ as RUNTIME

if TYPE_CHECKING:
    from common.bus.bus import BusError
    from common.bus.bus_keys import KeysError
    from common.config.part_settings import SettingsError
    from common.rig.rig_file import CalibrationError
    from common.video.clip_sources import ClipError
    from common.video.pictures import DecoderDied
    from runtime.client import (
        ANGLE_NAMES,
        JOINT_NAMES,
        POSE_INDEX,
        Body,
        Posture,
        Subscription,
        View,
        load_run,
        subscribe,
        track,
    )
    from runtime.steps.loop_bodies import Bodies
    from runtime.steps.tracker import Tracker
    from runtime.store.past_run import PastRunError
    from tritrack.export_formats import ExportError
    from tritrack.exporting import export

__all__ = [
    "ANGLE_NAMES",
    "JOINT_NAMES",
    "POSE_INDEX",
    "Bodies",
    "Body",
    "BusError",
    "CalibrationError",
    "ClipError",
    "DecoderDied",
    "ExportError",
    "KeysError",
    "PastRunError",
    "Posture",
    "SettingsError",
    "Subscription",
    "Tracker",
    "View",
    "export",
    "load_run",
    "subscribe",
    "track",
]

ELSEWHERE: Final = {
    "Bodies": f"{RUNTIME}.steps.loop_bodies",
    "BusError": f"{COMMON}.bus.bus",
    "CalibrationError": f"{COMMON}.rig.rig_file",
    "ClipError": f"{COMMON}.video.clip_sources",
    "DecoderDied": f"{COMMON}.video.pictures",
    "ExportError": "tritrack.export_formats",
    "KeysError": f"{COMMON}.bus.bus_keys",
    "PastRunError": f"{RUNTIME}.store.past_run",
    "SettingsError": f"{COMMON}.config.part_settings",
    "Tracker": f"{RUNTIME}.steps.tracker",
    "export": "tritrack.exporting",
}
"""Modules of the public names that are not in `runtime.client`, as a wheel calls them too."""


def __getattr__(name: str) -> Any:
    """The public names, loaded on first use: a command must handle signals before."""
    if name == "Report":
        warn("tritrack.Report is now View: use tritrack.View", DeprecationWarning, stacklevel=2)
        name = "View"
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(ELSEWHERE.get(name, f"{RUNTIME}.client")), name)
