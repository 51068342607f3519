"""Two reports in, one body out: position, body, facing, pose, in the order of section 4."""

import math
from typing import Final, Literal, NamedTuple

import numpy as np

from common.bits import count
from common.body import (
    ANGLE_NAMES,
    ANGLES_IN_POSE,
    POSE_INDEX,
    Vector,
    body_vector,
    rest_pose,
    thesis_bdp,
)
from common.camera import Rig, paper_rig, project
from common.config import Settings
from common.kernel import draw_body, match, view_of
from common.kinematics import ALL_LIMBS, joints
from common.messages import (
    Body,
    Box,
    Facing,
    Guide,
    Pixel,
    Point,
    Report,
    Status,
    ViewerNumber,
    Views,
    pack,
)
from integrator import adapting, opening, smoothing
from integrator.arbiter import Sight, arbitrate
from integrator.assumed import assumed_rig
from integrator.fusion import fused
from integrator.hypotheses import settled
from integrator.opening import Opening
from integrator.outlines import packed
from integrator.pairing import Pair
from integrator.place import pixels_of, place_of, roots_of, scales_at, scales_since

YAW_DEG: Final = (0.0, -90.0)
"""Yaw of the trunk while viewer 1, or viewer 2, sees the facade (P49)."""

LOST_SCORE, LOST_FRAMES = 0.35, 5
"""A model that fits this badly in every view is not believed; for so many frames, it is lost."""

VIEWERS: Final[tuple[ViewerNumber, ...]] = (1, 2)

Seen = tuple[Report | None, Report | None]


class State(NamedTuple):
    """What the integrator remembers between pairs."""

    settings: Settings
    rig: Rig | None
    """None until somebody is seen, where no calibration is given."""
    scale_source: Literal["calibrated", "assumed"]
    smooth: smoothing.State
    opening: Opening = Opening()
    pose: Vector | None = None
    """Last fused pose; None while nobody is there."""
    facing: tuple[Facing, Facing] = ("facade", "flank")
    frames: tuple[int, int] = (-1, -1)
    """The last frame that was heard of each viewer."""
    last_s: float | None = None
    badly: int = 0
    """For how many frames the model has fitted badly."""


def init(rig: Rig | None, period_s: float, settings: Settings) -> State:
    """An integrator that has heard nothing.

    Args:
        rig: The calibrated cameras of viewer 1 and viewer 2, for the working size; None: a rig
            of the paper's kind is assumed when somebody is seen.
        period_s: Time between frames.
        settings: Of the run.
    """
    source: Literal["calibrated", "assumed"] = "assumed" if rig is None else "calibrated"
    return State(settings, rig, source, smoothing.init(len(ANGLE_NAMES), period_s))


def step(state: State, pair: Pair) -> tuple[State, Body, Guide]:
    """One instant: what each viewer reports of it becomes one body, and a guide for the next.

    Universal BDPs come from the opening posture (P46), the arbiter settles the facing (P48),
    position and angles are fused (P50-P54) and smoothed; the viewers are told BDPs, positions
    and facing for their next frame (P2).
    """
    newest = max((r for r in pair if r is not None), key=lambda report: report.clock_s)
    dt_s = 0.0 if state.last_s is None else max(0.0, newest.captured_s - state.last_s)
    state = state._replace(frames=_heard(state.frames, pair), last_s=newest.captured_s)
    seen = _with_somebody(pair)
    state = _with_rig(state, seen)
    rig = state.rig
    if seen == (None, None) or rig is None:
        return _empty(state, pair, newest)
    known, settled_at = opening.step(state.opening, rig, seen, state.settings.body.opening_frames)
    state = _faced(state._replace(opening=known), seen)
    pose = _settled(state, rig, seen, _posed(state, rig, seen, settled_at))
    if state.settings.mode == "default":
        state = state._replace(opening=adapting.step(state.opening, rig, seen, pose))
    return _told(state._replace(pose=pose), rig, pair, newest, dt_s, settled_at is not None)


def _heard(frames: tuple[int, int], pair: Pair) -> tuple[int, int]:
    first, second = pair
    return (
        frames[0] if first is None else first.frame,
        frames[1] if second is None else second.frame,
    )


def _with_somebody(pair: Pair) -> Seen:
    first, second = pair
    return (
        first if first is not None and first.root_px is not None else None,
        second if second is not None and second.root_px is not None else None,
    )


def _with_rig(state: State, seen: Seen) -> State:
    """The rig, assumed at the first sight of a whole person where none is calibrated."""
    whole = [report for report in seen if report is not None and not report.cut]
    if state.rig is not None or not whole:
        return state
    return state._replace(rig=assumed_rig(whole[0], whole[-1], state.settings.body.stature_m))


def _faced(state: State, seen: Seen) -> State:
    """Facade and flank, settled between the views' votes (P48); one view alone decides itself."""
    first, second = seen
    if first is None or second is None:
        own = first or second
        assert own is not None
        other: Facing = "flank" if own.vote == "facade" else "facade"
        facing = (own.vote, other) if second is None else (other, own.vote)
        return state._replace(facing=facing)
    sights = [
        Sight(before, report.vote, report.upper_body_px, *report.thresholds_px)
        for before, report in zip(state.facing, (first, second), strict=True)
    ]
    ratio = 1.0
    if state.settings.mode == "default" and state.pose is not None and state.rig is not None:
        scales = scales_at(state.rig, state.pose[:3])
        ratio = scales[0] / scales[1]
    return state._replace(facing=arbitrate(sights[0], sights[1], ratio))


def _posed(state: State, rig: Rig, seen: Seen, settled_at: Vector | None) -> Vector:
    """Position and angles of this instant, not yet smoothed (P50-P54)."""
    front = 0 if state.facing[0] == "facade" else 1
    before = rest_pose() if state.pose is None else state.pose
    pose = fused(before, seen[front], seen[1 - front])
    if settled_at is None:
        pose[:3] = place_of(rig, roots_of(seen), before[:3], front)
    else:
        pose[:3] = settled_at
    pose[POSE_INDEX["torso_y"]] = YAW_DEG[front]
    return pose


def _settled(state: State, rig: Rig, seen: Seen, pose: Vector) -> Vector:
    """What one view alone cannot tell, by both silhouettes: a departure from the paper (L2, L3)."""
    first, second = seen
    if state.settings.mode != "default" or first is None or second is None:
        return pose
    if (first.width, first.height) != (second.width, second.height):
        return pose
    assert state.opening.bdp is not None
    before = rest_pose() if state.pose is None else state.pose
    known, body = state.opening, body_vector(state.opening.bdp)
    upright_m = known.measured_at_m[1] if known.measured else float(body[8] + body[14])
    pose[POSE_INDEX["torso_x"]] = 0.0
    return settled(pose, before, body, rig, (first, second), upright_m, bool(known.samples))


def _told(
    state: State, rig: Rig, pair: Pair, newest: Report, dt_s: float, settled_now: bool
) -> tuple[State, Body, Guide]:
    """The body that is published and the guide that the viewers get."""
    assert state.pose is not None
    assert state.opening.bdp is not None
    body, pose = body_vector(state.opening.bdp), state.pose.copy()
    raw = pose[list(ANGLES_IN_POSE)]
    scores = [_score(body, pose, rig, n, report) for n, report in enumerate(pair)]
    fits = max(scores) >= LOST_SCORE
    believed = fits or state.smooth.P is None  # there is nothing else to go by yet
    smooth, angles, _ = smoothing.step(state.smooth, raw if believed else None, dt_s)
    state = state._replace(smooth=smooth, badly=0 if fits else state.badly + 1)
    pose[list(ANGLES_IN_POSE)] = angles
    status = _status(state)
    places = joints(body, pose)
    confident = max(scores) if fits else 0.0
    told = Body(
        frame=_frame_of(pair, state.frames),
        captured_s=newest.captured_s,
        clock_s=newest.clock_s,
        status=status,
        views=_views(_with_somebody(pair)),
        joints_m=tuple(_point(place) for place in places),
        joints_px=tuple(_pixels(project(camera, places)) for camera in rig.cameras),
        pose=tuple(pose.tolist()),
        angles_raw_deg=tuple(raw.tolist()),
        confidence=(confident,) * len(places),
        score=(scores[0], scores[1]),
        facing=state.facing,
        bdp=state.opening.bdp,
        matches=sum(report.matches for report in pair if report is not None),
    )
    return state, told, _guide(state, rig, pair, newest, status, settled_now)


def _status(state: State) -> Status:
    """By presence, the opening and the fit together: never by S alone (M25)."""
    if state.badly >= LOST_FRAMES:
        return "lost"
    if state.badly:
        return "predicted"
    return "measuring" if state.opening.under_way else "tracking"


def _score(body: Vector, pose: Vector, rig: Rig, n: int, report: Report | None) -> float:
    """S of the whole body in one picture, true perspective; 0 where that view has nobody."""
    if report is None or report.root_px is None:
        return 0.0
    seen, view = packed(report), view_of(rig.cameras[n])
    return float(match(body, pose, view, ALL_LIMBS, report.width, seen, count(seen)))


def _guide(
    state: State, rig: Rig, pair: Pair, newest: Report, status: Status, settled_now: bool
) -> Guide:
    """What the viewers need for their next frame.

    As printed each starts where it had the body itself; in `default` where both together have it.
    """
    assert state.pose is not None
    place, known = state.pose[:3], state.opening
    measured_at = np.array(known.measured_at_m) if known.measured else place
    roots = list(pixels_of(rig, place))
    for n, report in enumerate(pair):
        own = state.settings.mode == "paper" and not settled_now
        if own and report is not None and report.root_px is not None:
            roots[n] = report.root_px
    upright = pixels_of(rig, np.array([place[0], measured_at[1], place[2]]))
    return Guide(
        frame=_frame_of(pair, state.frames),
        captured_s=newest.captured_s,
        clock_s=newest.clock_s,
        frames=state.frames,
        status=status,
        bdp=known.bdp,
        measured=known.measured,
        facing=state.facing,
        scale_px_per_m=_or_unseen(scales_since(rig, place, measured_at)),
        reference_px_per_m=_or_unseen(scales_at(rig, measured_at)),
        root_px=(roots[0], roots[1]),
        rest_row_px=(upright[0][1], upright[1][1]),
        pose=tuple(state.pose.tolist()),
    )


def _empty(state: State, pair: Pair, newest: Report) -> tuple[State, Body, Guide]:
    """Nobody is in any view: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    state = state._replace(pose=None, badly=0, smooth=fresh)
    body = Body(
        frame=_frame_of(pair, state.frames),
        captured_s=newest.captured_s,
        clock_s=newest.clock_s,
        status="empty",
        views="none",
        facing=state.facing,
        bdp=state.opening.bdp,
    )
    guide = Guide(
        frame=_frame_of(pair, state.frames),
        captured_s=newest.captured_s,
        clock_s=newest.clock_s,
        frames=state.frames,
        bdp=state.opening.bdp,
        measured=state.opening.measured,
        facing=state.facing,
        pose=tuple(rest_pose().tolist()),
    )
    return state, body, guide


def _views(seen: Seen) -> Views:
    names: dict[tuple[bool, bool], Views] = {(True, True): "both", (True, False): "1"}
    names |= {(False, True): "2", (False, False): "none"}
    return names[seen[0] is not None, seen[1] is not None]


def _frame_of(pair: Pair, heard: tuple[int, int]) -> int:
    """Rows are counted by camera 1's frames, or by camera 2's where it is alone.

    -1 for an instant that camera 1 missed.
    """
    first, second = pair
    if first is None and heard[0] < 0 and second is not None:
        return second.frame
    return -1 if first is None else first.frame


def _or_unseen(scales: tuple[float, float]) -> tuple[float, float]:
    """Scales with 0 for a camera that has the body behind it."""
    first, second = (scale if math.isfinite(scale) and scale > 0 else 0.0 for scale in scales)
    return first, second


def _point(place: Vector) -> Point:
    x, y, z = (float(value) for value in place)
    return (x, y, z)


def _pixels(pixels: Vector) -> tuple[Pixel, ...]:
    return tuple((u, v) for u, v in np.nan_to_num(pixels, nan=-1.0).tolist())


def rehearse(settings: Settings, size: tuple[int, int]) -> None:
    """Merge made-up reports, so that all is compiled and loaded before the first real ones."""
    width, height = size
    body = body_vector(thesis_bdp(1.75))
    state = init(None, 1.0, settings)
    for index in range(3):
        reports = []
        for viewer in VIEWERS:
            rig = paper_rig(size, (1.25 * width,) * 2, (4.5, 4.5))
            pose = rest_pose()
            pose[POSE_INDEX["y"]] = 1.0
            mask = draw_body(body, pose, view_of(rig.cameras[viewer - 1]), size)
            rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
            box = Box(int(columns[0]), int(columns[-1]), int(rows[0]), int(rows[-1]))
            reports.append(
                Report(
                    frame=index,
                    captured_s=float(index),
                    clock_s=float(index),
                    viewer=viewer,
                    width=width,
                    height=height,
                    silhouette=pack(mask),
                    box=box,
                    root_px=(width / 2, height / 2),
                )
            )
        state, _, _ = step(state, Pair(reports[0], reports[1]))
