"""A body as a stream of the Lab Streaming Layer, stamped with the frame's capture time."""

import math
import time
from collections.abc import Callable
from typing import Any, Final

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES
from common.bus.messages import Body
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


def lsl_outlet(name: str = "tritrack") -> Callable[[Body], None]:
    """A sender of bodies into a stream that recorders on the network find by name.

    Raises:
        BridgeError: When pylsl is not installed.
    """
    try:
        import pylsl
    except (ImportError, RuntimeError) as error:
        raise BridgeError("LSL needs pylsl: pip install 'tritrack[lsl]'") from error
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
        age_s = time.monotonic() - body.clock_s
        outlet.push_sample(sample_of(body), pylsl.local_clock() - age_s)

    return push
