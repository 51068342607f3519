"""The front door: the commands, the processes that they start, and what programs import."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from runtime.client import (
        ANGLE_NAMES,
        JOINT_NAMES,
        POSE_INDEX,
        Body,
        Posture,
        Report,
        Subscription,
        subscribe,
        track,
    )

__all__ = [
    "ANGLE_NAMES",
    "JOINT_NAMES",
    "POSE_INDEX",
    "Body",
    "Posture",
    "Report",
    "Subscription",
    "subscribe",
    "track",
]


def __getattr__(name: str) -> Any:
    """What programs import, loaded when it is asked for: a command must heed signals before."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from runtime import client

    return getattr(client, name)
