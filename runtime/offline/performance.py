"""Every instant of a clip: its viewers and the integrator in lock-step, from first to last."""

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Final, NamedTuple

from calibration.gate.odd_camera import OddCamera
from common.bus.instant import instant_of
from common.bus.messages import Body, Guide, View, ViewerNumber
from common.video.clip_facts import Clip
from integrator import diagnostics
from integrator.live_rig.live_calibration import LiveCalibration, Looking
from integrator.live_rig.rig_solver import SolverAtOnce
from integrator.people import recognition, several
from integrator.people.lived_instant import Merged
from integrator.people.own_views import own_views
from runtime.offline.frame_pairs import instants, share_of
from runtime.offline.rig_check import Seen, Witness
from runtime.steps.frame_cache import FrameCache
from runtime.steps.together import joined, looked
from runtime.unfinished.unfinished_run import BODIES
from runtime.unfinished.work import Course
from viewer import track
from viewer.captured_frame import CapturedFrame
from viewer.landmarks.landmark_sources import Sources

STAGE: Final = "instants"
TURNS_S: Final = 0.0002
"""Python's thread switch interval, seconds: with its default of 5 ms two viewers in parallel
would be no faster than one after the other."""

Each = Callable[[dict[ViewerNumber, CapturedFrame], dict[int, View], tuple[Body, ...]], object]
"""Receives the frames of an instant, their reports and its bodies."""


class Watch(NamedTuple):
    """Observes the tracking of a clip."""

    each: Each
    begin: Callable[[], object] = lambda: None
    """Forget all: the clip is tracked from its first instant again."""


class Prepared(NamedTuple):
    """A clip that is ready to be tracked."""

    clip: Clip
    frame_caches: dict[ViewerNumber, FrameCache]
    viewers: dict[ViewerNumber, track.State]
    integrator: recognition.State
    odd: list[str]
    """Warnings about its backgrounds."""
    seconds: float
    """Seconds of preparing them."""
    odd_camera: OddCamera | None = None
    """The camera that the clip's rig has turned back."""


class LockstepState(NamedTuple):
    """The whole state between instants."""

    viewers: dict[ViewerNumber, track.State]
    integrator: recognition.State
    calibration: Looking
    witness: Seen
    noticed: diagnostics.State
    guide: Guide | None
    starts: dict[ViewerNumber, int]
    """The next frame of each view that has had one."""
    spent: dict[str, float]
    """Seconds of each stage."""
    late_s: tuple[float, ...] = ()
    """Time by which the times of each view after the first are set back."""
    odd_camera: OddCamera | None = None
    """The camera that the rig has turned back."""


class Performance(NamedTuple):
    """The result of tracking a clip."""

    bodies: Sequence[Body]
    integrator: recognition.State
    noticed: diagnostics.State
    news: tuple[str, ...]
    """Reports about the rig."""
    seconds: dict[str, float]
    """Seconds of each stage."""


def performed(
    ready: Prepared, sources: Sources, witness: Witness, watch: Watch | None, course: Course
) -> Performance:
    """Track a clip, from where it was interrupted; an instant's views run in parallel.

    Args:
        ready: The clip.
        sources: Sources of landmarks.
        witness: Receives every instant.
        watch: Likewise, where there is one.
        course: Receives the progress, and stores the bodies.
    """
    clip, work = ready.clip, course.work
    calibration = LiveCalibration(ready.integrator.room, looks=False, solver=SolverAtOnce())
    going = work.resumed(STAGE, LockstepState) or _begun(ready, calibration, witness)
    calibration.looking, witness.seen = going.calibration, going.witness
    bodies = work.messages(BODIES)
    before_s, began = going.spent["following"], time.perf_counter()
    with _side_by_side(len(clip.views)) as pool:
        for frames in instants(clip, ready.frame_caches, sources, going.starts):
            going, reports, merged = _stepped(going, frames, calibration, pool)
            for body in merged.bodies:
                bodies.append(body)
            for body, own in own_views(reports, merged):
                witness(frames, own, body)
            if watch:
                watch.each(frames, reports, merged.bodies)
            course.tell(share_of(clip, frames))
            if work.due:
                now_s = before_s + time.perf_counter() - began
                work.save(STAGE, _saved(going, calibration, witness, now_s))
    going = _saved(going, calibration, witness, before_s + time.perf_counter() - began)
    return Performance(bodies, going.integrator, going.noticed, calibration.news, going.spent)


@contextmanager
def _side_by_side(count: int) -> Iterator[Executor]:
    """Threads with a short switch interval."""
    turns_s = sys.getswitchinterval()
    sys.setswitchinterval(TURNS_S)
    try:
        with ThreadPoolExecutor(count) as pool:
            yield pool
    finally:
        sys.setswitchinterval(turns_s)


def _begun(ready: Prepared, calibration: LiveCalibration, witness: Witness) -> LockstepState:
    return LockstepState(
        ready.viewers,
        ready.integrator,
        calibration.looking,
        witness.seen,
        noticed=diagnostics.State(),
        guide=None,
        starts={},
        spent={"viewers": 0.0, "integrator": 0.0, "following": 0.0},
        late_s=tuple(view.late_s for view in ready.clip.views[1:]),
        odd_camera=ready.odd_camera,
    )


def _stepped(
    going: LockstepState,
    frames: dict[ViewerNumber, CapturedFrame],
    calibration: LiveCalibration,
    pool: Executor,
) -> tuple[LockstepState, dict[int, View], Merged]:
    """Process one instant."""
    start = time.perf_counter()
    viewers, reports = looked(going.viewers, frames, going.guide, pool.map)
    starts = going.starts | {number: frame.index + 1 for number, frame in frames.items()}
    middle = time.perf_counter()
    state, merged = joined(going.integrator, reports, calibration)
    spent = dict(going.spent)
    spent["viewers"] += middle - start
    spent["integrator"] += time.perf_counter() - middle
    instant = instant_of(reports, len(state.room.frames))
    going = going._replace(
        viewers=viewers,
        integrator=state,
        noticed=diagnostics.step(going.noticed, instant, several.present(state, merged)),
        guide=merged.guide,
        starts=starts,
        spent=spent,
    )
    return going, reports, merged


def _saved(
    going: LockstepState, calibration: LiveCalibration, witness: Witness, following_s: float
) -> LockstepState:
    """With the state kept elsewhere."""
    return going._replace(
        calibration=calibration.looking,
        witness=witness.seen,
        spent={**going.spent, "following": following_s},
    )
