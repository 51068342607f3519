"""Every instant of a clip: its viewers and the integrator in lock-step, from first to last."""

import time
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from common.bus.messages import Body, Guide, Report, ViewerNumber
from common.video.clip_facts import Clip
from common.video.frame_cache import Reel
from integrator import diagnostics, merge, merge_state
from integrator.live_rig.live_calibration import LiveCalibration, Looking
from integrator.live_rig.rig_solver import SolverAtOnce
from integrator.pairing import Pair
from tritrack.offline.frame_pairs import instants, share_of
from tritrack.offline.rig_check import Seen, Witness
from tritrack.unfinished.unfinished_run import BODIES
from tritrack.unfinished.work import Course
from viewer import track
from viewer.capture import CapturedFrame
from viewer.landmarks.landmark_sources import Sources

STAGE: Final = "instants"

Watch = Callable[[dict[ViewerNumber, CapturedFrame], dict[int, Report], Body], object]
"""Looks at the frames of an instant, the reports on them and the body they gave."""


class Prepared(NamedTuple):
    """A clip that can be followed."""

    clip: Clip
    reels: dict[ViewerNumber, Reel]
    viewers: dict[ViewerNumber, track.State]
    integrator: merge_state.State
    odd: list[str]
    """What is odd about its backgrounds."""
    seconds: float
    """What that took."""


class Going(NamedTuple):
    """All that is remembered from one instant to the next."""

    viewers: dict[ViewerNumber, track.State]
    integrator: merge_state.State
    calibration: Looking
    witness: Seen
    noticed: diagnostics.State
    guide: Guide | None
    starts: dict[ViewerNumber, int]
    """The next frame of each view that has given one."""
    spent: dict[str, float]
    """Seconds of each stage."""


class Performance(NamedTuple):
    """What following a clip gave."""

    bodies: Sequence[Body]
    integrator: merge_state.State
    noticed: diagnostics.State
    news: tuple[str, ...]
    """What became of the rig."""
    seconds: dict[str, float]
    """Of each stage."""


def performed(
    ready: Prepared, sources: Sources, witness: Witness, watch: Watch | None, course: Course
) -> Performance:
    """Follow a clip, from where it was left.

    Args:
        ready: The clip.
        sources: Of landmarks.
        witness: Sees every instant.
        watch: Likewise, where there is one.
        course: Is told how far it is, and keeps the bodies.
    """
    clip, work = ready.clip, course.work
    calibration = LiveCalibration(ready.integrator, looks=False, solver=SolverAtOnce())
    going = work.resumed(STAGE, Going) or _begun(ready, calibration, witness)
    calibration.looking, witness.seen = going.calibration, going.witness
    bodies = work.messages(BODIES)
    before_s, began = going.spent["following"], time.perf_counter()
    for frames in instants(clip, ready.reels, sources, going.starts):
        going, reports, body = _stepped(going, frames, calibration)
        bodies.append(body)
        for each in (witness, watch) if watch else (witness,):
            each(frames, reports, body)
        course.tell(share_of(clip, frames))
        if work.due:
            now_s = before_s + time.perf_counter() - began
            work.save(STAGE, _saved(going, calibration, witness, now_s))
    going = _saved(going, calibration, witness, before_s + time.perf_counter() - began)
    return Performance(bodies, going.integrator, going.noticed, calibration.news, going.spent)


def _begun(ready: Prepared, calibration: LiveCalibration, witness: Witness) -> Going:
    return Going(
        ready.viewers,
        ready.integrator,
        calibration.looking,
        witness.seen,
        noticed=diagnostics.State(),
        guide=None,
        starts={},
        spent={"viewers": 0.0, "integrator": 0.0, "following": 0.0},
    )


def _stepped(
    going: Going, frames: dict[ViewerNumber, CapturedFrame], calibration: LiveCalibration
) -> tuple[Going, dict[int, Report], Body]:
    """One instant more."""
    start = time.perf_counter()
    viewers, starts = dict(going.viewers), dict(going.starts)
    reports: dict[int, Report] = {}
    for number, frame in frames.items():
        viewers[number], reports[number] = track.step(viewers[number], frame, going.guide)
        starts[number] = frame.index + 1
    middle = time.perf_counter()
    pair = Pair(reports.get(1), reports.get(2))
    state, body, guide = merge.step(going.integrator, pair)
    calibration.heard(pair)
    state = calibration.changed(state)
    spent = dict(going.spent)
    spent["viewers"] += middle - start
    spent["integrator"] += time.perf_counter() - middle
    going = going._replace(
        viewers=viewers,
        integrator=state,
        noticed=diagnostics.step(going.noticed, pair),
        guide=guide,
        starts=starts,
        spent=spent,
    )
    return going, reports, body


def _saved(
    going: Going, calibration: LiveCalibration, witness: Witness, following_s: float
) -> Going:
    """With what is remembered elsewhere."""
    return going._replace(
        calibration=calibration.looking,
        witness=witness.seen,
        spent={**going.spent, "following": following_s},
    )
