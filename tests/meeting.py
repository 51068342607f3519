"""A run that says made-up bodies on a bus of its own, for whoever listens from outside."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from moving import random_joints
from msgspec.structs import replace

from common.body.body import rest_pose
from common.body.extremities import extremities
from common.bus.bus import open_hub
from common.bus.messages import Body
from common.config.part_settings import BusSettings
from runtime.live.free_ports import free_port

HZ = 30.0


def free_endpoint() -> str:
    return f"tcp/127.0.0.1:{free_port()}"


def a_body(frame: int, joints_m: np.ndarray) -> Body:
    now_s = time.monotonic()
    ends_m = extremities(joints_m, 1.75)
    return Body(
        frame=frame,
        captured_s=frame / HZ,
        clock_s=now_s,
        status="tracking",
        views="both",
        joints_m=tuple(map(tuple, joints_m.tolist())),
        pose=tuple(rest_pose().tolist()),
        confidence=(0.5,) * 15,
        extremities_m=tuple(map(tuple, ends_m.tolist())),
        extremities_confidence=(0.0,) * len(ends_m),
    )


EARLY = -1
"""Frame of every body that is said before the first."""


@contextmanager
def saying(
    frames: int = 120, begin: threading.Event | None = None, people: tuple[int, ...] = (0,)
) -> Iterator[str]:
    """The endpoint of a hub that says so many bodies, 30 a second, of each of these people.

    Where there is an event it says an early one over and over until that is set: who hears it is
    there, and will miss none.
    """
    endpoint, joints_m = free_endpoint(), random_joints(3)
    over = threading.Event()

    def say() -> None:
        with open_hub(BusSettings(endpoint), "room") as bus:
            bus.announce("integrator")
            while begin is not None and not begin.is_set() and not over.wait(1 / HZ):
                for person in people:
                    bus.publish(replace(a_body(EARLY, joints_m[0]), person=person))
            for frame in range(frames):
                if over.wait(1 / HZ):
                    return
                for person in people:
                    row = joints_m[frame % len(joints_m)]
                    bus.publish(replace(a_body(frame, row), person=person))

    thread = threading.Thread(target=say)
    thread.start()
    try:
        yield endpoint
    finally:
        over.set()
        thread.join()
