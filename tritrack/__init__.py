"""The front door: the commands, and the public API for programs."""

from typing import TYPE_CHECKING, Any
from warnings import warn

if TYPE_CHECKING:
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
    from tritrack.exporting import export

__all__ = [
    "ANGLE_NAMES",
    "JOINT_NAMES",
    "POSE_INDEX",
    "Bodies",
    "Body",
    "Posture",
    "Subscription",
    "Tracker",
    "View",
    "export",
    "load_run",
    "subscribe",
    "track",
]


def __getattr__(name: str) -> Any:
    """The public names, loaded on first use: a command must handle signals before."""
    if name == "Report":
        warn("tritrack.Report is now View: use tritrack.View", DeprecationWarning, stacklevel=2)
        name = "View"
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name in ("Bodies", "Tracker"):
        from runtime.steps import tracker

        return getattr(tracker, name)
    if name == "export":
        from tritrack.exporting import export

        return export
    from runtime import client

    return getattr(client, name)
