"""What landmarks add: outlines alone, landmarks alone, and both, for each source of landmarks.

Run from the checkout, on calibrated clips with a truth:

    .venv/bin/python benchmarks/landmark_ablation.py clips/*/ [--sources own mediapipe]
        [--size 320x240] [--hurried N]

"Alone" are landmarks whose rays of both views are brought together joint by joint (the point
nearest to both), sides as each view tells them, nothing remembered. Prints a table in Markdown:
mean error of 12 joints, of the inner angles, share of frames lost, and CPU milliseconds a view
that the source takes in the tracking process (MediaPipe works in processes of its own). With
`--hurried 6` also where only every sixth picture is looked into, as by a live viewer that is late.
"""

import argparse
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import msgspec
import numpy as np
from threadpoolctl import threadpool_limits

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.bus.messages import Body, Guide, View
from common.config import config_file
from common.config.settings import Settings
from common.rig.camera import Rig
from common.video.clip_facts import whole_rig
from common.video.clips import open_clip
from integrator.rig.body_position import triangulate
from integrator.rig.undistortion import undistorted_rig
from lab.accuracy.accuracy import Compared, compare, summary
from runtime.offline.lockstep import Decoders, track_clip
from runtime.offline.performance import Watch
from runtime.overrides import overridden
from runtime.store.pose_arrays import poses
from viewer import track
from viewer.captured_frame import CapturedFrame
from viewer.landmarks import own_landmarks


def _landmarks(view: View | None) -> Landmarks | None:
    return None if view is None or view.person is None else view.person.landmarks


class Clock:
    """How long the looks of our own network took."""

    def __init__(self) -> None:
        """None yet."""
        self.looks, self.spent_s = 0, 0.0

    def watched(self, look: Any) -> Any:
        """The same look, timed."""

        def timed(*given: Any) -> Any:
            began_s = time.thread_time()
            found = look(*given)
            self.spent_s += time.thread_time() - began_s
            self.looks += 1
            return found

        return timed


class Alone:
    """The bodies of both views' landmarks; none where a view has none."""

    def __init__(self, rig: Rig) -> None:
        """No instant yet."""
        first, second = undistorted_rig(rig).cameras
        self.cameras, self.bodies = (first, second), list[Body]()

    def watch(self, _: object, reports: dict[int, View], bodies: tuple[Body, ...]) -> None:
        """One instant."""
        first, second = (_landmarks(reports.get(n)) for n in (1, 2))
        joints: tuple[Any, ...] = ()
        if first is not None and second is not None:
            pairs = zip(first.joints_px, second.joints_px, strict=True)
            joints = tuple(tuple(triangulate(self.cameras, pair).tolist()) for pair in pairs)
        self.bodies.append(msgspec.structs.replace(bodies[0], joints_m=joints))


def followed(clips: Sequence[Path], source: str, size: str | None) -> dict[str, list[Compared]]:
    """Every clip with a source: of its landmarks alone, and of all together."""
    found: dict[str, list[Compared]] = {"alone": [], "both": []}
    with Decoders() as decoders:
        for clip in clips:
            settings = overridden(config_file.load(clip), "default", size)
            settings = msgspec.structs.replace(settings, landmarks=source)
            single = Alone(rig_of(clip, decoders, settings))
            done = track_clip(settings, decoders, watch=Watch(single.watch))
            with np.load(clip / "truth.npz", allow_pickle=False) as truth:
                for how, bodies in (("both", done.bodies), ("alone", single.bodies)):
                    rows = poses([body for body in bodies if body.frame >= 0])
                    found[how].append(compare(rows, truth))
    return found


@contextmanager
def hurried(every: int) -> Iterator[None]:
    """All frames but every n-th are in a hurry."""
    look = track.look

    def in_a_hurry(state: track.State, frame: CapturedFrame, guide: Guide | None) -> Any:
        is_hurried = frame.index % every != 0
        return look(state, msgspec.structs.replace(frame, hurried=is_hurried), guide)

    track.look = in_a_hurry
    try:
        yield
    finally:
        track.look = look


def rig_of(clip: Path, decoders: Decoders, settings: Settings) -> Rig:
    """Both cameras of a calibrated clip."""
    rig = whole_rig(open_clip(settings, decoders.of[1]))
    if rig is None:
        raise SystemExit(f"{clip}: no calibration")
    return rig


def line(what: str, clips: Sequence[Compared], cost: str = "") -> str:
    told = summary(clips)
    cells = f"{told['abs_mm']['mean']:.1f} | {told['angle_deg']['all']:.1f}"
    return f"| {what} | {cells} | {100 * told['lost']:.1f} % | {cost} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("clips", type=Path, nargs="+", help="clip folders with a truth.npz")
    parser.add_argument("--sources", nargs="+", default=["own"])
    parser.add_argument("--size", help="bound of the working picture")
    parser.add_argument("--hurried", type=int, help="where only every n-th picture is looked into")
    given = parser.parse_args()
    bare = [clip for clip in given.clips if not (clip / "truth.npz").is_file()]
    if bare:
        parser.error(f"{bare[0]} has no truth.npz")
    clock = Clock()
    own_landmarks._look = clock.watched(own_landmarks._look)
    print(
        f"| of {len(JOINT_NAMES)} joints | mm | degrees | lost | ms a look |\n|---|---|---|---|---|"
    )
    print(line("outlines alone", followed(given.clips, "none", given.size)["both"]), flush=True)
    for source in given.sources:
        clock.looks, clock.spent_s = 0, 0.0
        found = followed(given.clips, source, given.size)
        cost = f"{1e3 * clock.spent_s / clock.looks:.2f}" if clock.looks else "its own process"
        print(line(f"landmarks alone, {source}", found["alone"], cost))
        print(line(f"both, {source}", found["both"]), flush=True)
    if given.hurried:
        with hurried(given.hurried):
            found = followed(given.clips, "own", given.size)
        print(line(f"both, own, a look every {given.hurried} frames", found["both"]), flush=True)


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
