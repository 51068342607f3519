"""Output of an instant: the body, for all."""

from collections.abc import Sequence
from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLES_IN_POSE, JOINT_NAMES, Vector
from common.body.extremities import extremities
from common.body.observation import Facing, Observation, Pixel
from common.body.proportions import stature
from common.bus.instant import Instant, Seen
from common.bus.messages import Agreement, Body, Point, Status, Views
from common.npz_file import Facts
from common.rig.camera import project
from common.rig.upright import Upright
from common.rig.upright_camera import as_filed
from integrator.belief import status_of
from integrator.landmarks.extremity_sight import seen_extremities
from integrator.merge_state import State
from integrator.person import Following, Sighting

OUTSIDE: Final = "partly outside the picture: "
"""Begin of the advice to a person whom the picture cuts off."""


def body_of(
    state: State, person: Following, now: Sighting, angles_deg: Vector, scores: tuple[float, ...]
) -> Body:
    """The body in its pose, with smoothed angles; a lost one has no pose.

    Args:
        state: Of this instant.
        person: Of this instant.
        now: The views of the instant.
        angles_deg: The smoothed angles, ANGLE_NAMES order.
        scores: S of the pose in each view.
    """
    pose = person.pose.copy()
    pose[list(ANGLES_IN_POSE)] = angles_deg
    places_m = person.places_m(pose)
    pixels = tuple(project(camera, places_m) for camera in now.filed_rig.cameras)
    told = state.agreement.told if sum(map(bool, now.seen)) > 1 else None
    believed = _believed(state, told)
    outside = _outside(now.instant, pixels)
    confidence = np.where(outside, 0.0, _confidence(person, scores) * believed)
    status, posed = status_of(person, state.period_s), {}
    if status != "lost":
        posed = {
            "joints_m": points(places_m),
            "joints_px": _filed(state, pixels),
            "pose": tuple(pose.tolist()),
            "angles_raw_deg": tuple(person.pose[list(ANGLES_IN_POSE)].tolist()),
            **_extremities(state, person, now, places_m, believed),
        }
    return Body(
        **_whereabouts(state, now.instant),
        **posed,
        status=status,
        views=_views(now.instant.detections),
        seen=tuple(seen is not None for seen in now.instant.detections),
        confidence=tuple(confidence.tolist()),
        score=scores,
        matches=sum(_matches(seen) for seen in now.instant.detections if seen is not None),
        lifting=None if person.found.alone is None else person.found.alone.lifting,
        agreement=told,
        advice=advice_of(now.instant.detections, state.facing, status),
    )


def predicted(state: State, lost: Body, last: Body, by_m: Vector) -> Body:
    """The body of a person whom no view shows: as it was last, moved; its confidence is 0.

    Args:
        state: Of this instant.
        lost: Of this instant, without a pose.
        last: As last believed.
        by_m: (3,) by how much it is moved since then.
    """
    cameras = () if state.rig is None else state.rig.cameras
    pose = np.array(last.pose)
    pose[:3] += by_m
    places_m, ends_m = np.array(last.joints_m) + by_m, np.array(last.extremities_m) + by_m
    return msgspec.structs.replace(
        lost,
        status="predicted",
        joints_m=points(places_m),
        joints_px=_filed(state, [project(camera, places_m) for camera in cameras]),
        pose=tuple(pose.tolist()),
        angles_raw_deg=last.angles_raw_deg,
        confidence=(0.0,) * len(places_m),
        extremities_m=points(ends_m),
        extremities_px=_filed(state, [project(camera, ends_m) for camera in cameras]),
        extremities_confidence=(0.0,) * len(ends_m),
    )


def advice_of(seen: Seen, facing: tuple[Facing, ...], status: Status) -> tuple[str, ...]:
    """For each camera, what a person can do; empty: nothing for any.

    Whoever is partly outside a picture is asked back into it. What is wrong with the opening
    posture matters while it is measured, and before the camera that sees the facade.

    Args:
        seen: The person in each view.
        facing: The side of the body that each view sees.
        status: Of the body.
    """
    advice = tuple(
        "" if one is None else _advice(one, side, status)
        for one, side in zip(seen, facing, strict=True)
    )
    return advice if any(advice) else ()


def _advice(one: Observation, facing: Facing, status: Status) -> str:
    if one.cut:
        is_large = one.box.top <= 0 or one.box.bottom >= one.height - 1
        return OUTSIDE + ("step back" if is_large else "step towards its middle")
    shows_posture = facing == "facade" or one.measure is None
    return one.refusal if status == "measuring" and shows_posture else ""


def no_person(state: State, instant: Instant) -> Body:
    """The output while no person is in any view."""
    cameras = len(instant.views)
    return Body(
        **_whereabouts(state, instant),
        status="empty",
        views="none",
        seen=(False,) * cameras,
        score=(0.0,) * cameras,
    )


def moment(state: State, instant: Instant) -> Facts:
    """The frame of an instant, and its capture time."""
    newest = instant.newest
    return {"frame": state.number, "captured_s": newest.captured_s, "clock_s": newest.clock_s}


def _whereabouts(state: State, instant: Instant) -> Facts:
    """Fields of any instant: its frames, the body's lengths and facing, and the rig."""
    return {
        **moment(state, instant),
        "facing": state.facing,
        "bdp": state.person.body.bdp,
        "scale_source": state.scale_source,
        "calibration": state.calibration,
        "moved": state.stands.doubtful,
        "made_of": tuple(-1 if view is None else view.frame for view in instant.views),
    }


def _extremities(
    state: State, person: Following, now: Sighting, places_m: Vector, believed: float
) -> Facts:
    """Nose, heels, toes and knuckles; confidence 0 where the rule alone places them."""
    stature_m = stature(person.body.bdp)
    ends_m = extremities(places_m, stature_m)
    measured = np.zeros(len(ends_m))
    if not person.doubted:
        ends_m, measured = seen_extremities(ends_m, now.rig, now.seen, stature_m)
    ends_px = [project(camera, ends_m) for camera in now.filed_rig.cameras]
    return {
        "extremities_m": points(ends_m),
        "extremities_px": _filed(state, ends_px),
        "extremities_confidence": tuple((measured * believed).tolist()),
    }


def _matches(seen: Observation) -> int:
    return sum(found.matches for found in (seen.search, seen.stick) if found is not None)


def _outside(instant: Instant, pixels: tuple[NDArray[np.float64], ...]) -> NDArray[np.bool_]:
    """Joints outside the only picture of a person, (15,): they are guessed."""
    seen = [(n, one) for n, one in enumerate(instant.detections) if one is not None]
    if len(seen) != 1 or not seen[0][1].cut:
        return np.zeros(len(JOINT_NAMES), np.bool_)
    ((own, person),) = seen
    places_px = pixels[own]
    shown = (places_px >= 0) & (places_px <= (person.width, person.height))
    return np.logical_not(shown.all(axis=1))


def _confidence(person: Following, scores: tuple[float, ...]) -> Vector:
    """Confidence of each joint, (15,): found with the pose, or from the fit of the whole body."""
    if person.doubted:
        return np.zeros(len(JOINT_NAMES))
    if person.found.confidence is not None:
        return person.found.confidence
    return np.full(len(JOINT_NAMES), max(scores))


def _believed(state: State, told: Agreement | None) -> float:
    """Factor on the confidence where the rig is not believable."""
    if state.settings.trust_calibration:
        return 1.0
    return min(state.stands.left, 1.0 if told is None else told.believed)


def _views(seen: Seen) -> Views:
    """The views that show the person: of two cameras "both", of more their numbers."""
    numbers = [str(n) for n, person in enumerate(seen, start=1) if person is not None]
    if len(seen) == len(numbers) == 2:
        return "both"
    return "+".join(numbers) or "none"


def points(places_m: Vector) -> tuple[Point, ...]:
    """Places (n, 3) as a message has them."""
    return tuple((x, y, z) for x, y, z in places_m.tolist())


def filed_pixels(pixels: NDArray[np.float64], upright: Upright | None) -> tuple[Pixel, ...]:
    """Pixels (n, 2) of a view's upright picture as a message has them: in its file's picture at the
    working size, -1 where a place is behind the camera."""
    filed = as_filed(pixels, upright)
    return tuple((u, v) for u, v in np.where(np.isnan(filed), -1.0, filed).tolist())


def _filed(state: State, pixels: Sequence[NDArray[np.float64]]) -> tuple[tuple[Pixel, ...], ...]:
    """Places in each view, in its file's picture at the working size."""
    views = zip(pixels, state.uprights, strict=True)
    return tuple(filed_pixels(own, upright) for own, upright in views)
