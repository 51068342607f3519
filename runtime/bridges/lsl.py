"""Bodies and postures as streams of the Lab Streaming Layer, stamped with its frame's time."""

import math
import time
from collections.abc import Callable
from typing import Any, Final

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES
from common.bus.messages import Body, Posture
from runtime.bridges.osc import BridgeError

CHANNELS: Final = (
    *((f"{joint}_{axis}_m", "metres") for joint in JOINT_NAMES for axis in "xyz"),
    *((f"{joint}_confidence", "probability") for joint in JOINT_NAMES),
    *((f"{angle}_deg", "degrees") for angle in ANGLE_NAMES),
)
"""Label and unit of each channel."""


def sample_of(body: Body) -> list[float]:
    """The values of CHANNELS; NaN where there is no pose."""
    if not (body.joints_m and body.pose):
        return [math.nan] * len(CHANNELS)
    places = [value for place_m in body.joints_m for value in place_m]
    return [*places, *body.confidence, *(body.pose[i] for i in ANGLES_IN_POSE)]


def marker_step(doing: str, posture: Posture) -> tuple[str, list[str]]:
    """The posture in progress, and the markers that this posture gives.

    Args:
        doing: The posture that was in progress before; "" for none.
        posture: The next frame's.
    """
    if posture.doing == doing:
        return doing, []
    ended = [f"end {doing}"] if doing else []
    begun = [f"begin {posture.doing}"] if posture.doing else []
    return posture.doing, ended + begun


def lsl_outlet(name: str = "tritrack") -> Callable[[Body], None]:
    """A sender of bodies into a stream that recorders on the network find by name.

    Raises:
        BridgeError: When pylsl is not installed.
    """
    pylsl = _library()
    info: Any = pylsl.StreamInfo(
        name, "MoCap", len(CHANNELS), pylsl.IRREGULAR_RATE, "float32", f"{name}-body"
    )
    channels = info.desc().append_child("channels")
    for label, unit in CHANNELS:
        channel = channels.append_child("channel")
        channel.append_child_value("label", label)
        channel.append_child_value("unit", unit)
    outlet = pylsl.StreamOutlet(info)

    def push(body: Body) -> None:
        outlet.push_sample(sample_of(body), _stamp_s(pylsl, body.clock_s))

    return push


def marker_outlet(name: str = "tritrack-postures") -> Callable[[str, float], None]:
    """A sender of markers, with the moment on the room's clock, into a stream of type Markers.

    Raises:
        BridgeError: When pylsl is not installed.
    """
    pylsl = _library()
    info = pylsl.StreamInfo(name, "Markers", 1, pylsl.IRREGULAR_RATE, "string", f"{name}-markers")
    outlet = pylsl.StreamOutlet(info)
    return lambda marker, clock_s: outlet.push_sample([marker], _stamp_s(pylsl, clock_s))


def _stamp_s(pylsl: Any, clock_s: float) -> float:
    """A moment of the room's clock on LSL's own."""
    stamp_s: float = pylsl.local_clock() - (time.monotonic() - clock_s)
    return stamp_s


def _library() -> Any:
    try:
        import pylsl
    except (ImportError, RuntimeError) as error:
        raise BridgeError("LSL needs pylsl: pip install 'tritrack[lsl]'") from error
    return pylsl
