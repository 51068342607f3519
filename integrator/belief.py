"""Whether a body is believed: landmarks in its pictures must agree with it."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import OTHER_SIDE
from common.body.observation import Landmarks, Observation
from common.body.proportions import stature
from common.bus.instant import Seen
from common.bus.messages import Status
from common.rig.camera import Camera, Rig, project
from integrator.person import Following, Person, Sighting, Waiting
from integrator.pose.possible_pose import has_possible_limbs, is_within_a_jump
from integrator.single.reflection import yaw_deg

LOST_SCORE: Final = 0.35
"""S below which, in every view, a body is not believed, unless trusted landmarks of two views
confirm it: clothes of the wall's colour leave hardly a silhouette."""
TRUSTED: Final = 0.5
"""Mean confidence of landmarks from which on they are compared with a body."""
SURE: Final = 0.5
"""Confidence of a single landmark that counts then."""
LEAST: Final = 5
"""Fewest such landmarks."""
ASTRAY: Final = 0.13
"""Median distance of the sure landmarks from the body's joints, in heights of the body, above
which it is not believed. It is 0.03 at most in 99 % of two performers' frames, and 0.17 in the
median of frames that are more than 200 mm off (docs/measurements.md)."""
FACES: Final = 0.8
"""Confidence of a view's facing from which on it is compared with the body's."""
TURNED_DEG: Final = 100.0
"""Difference of the facings, degrees, from which on a body is not believed."""
NOBODY: Final = 0.3
"""Mean confidence of the landmarks below which they show no person: 0.53 at least in two
performers' frames, 0.39 in those of synthetic people in free motion (docs/measurements.md)."""
UNTRUSTED_SCORE: Final = 0.45
"""Smallest S in each view where no view's landmarks are trusted: it is 0.6 in 99 % of two
performers' frames (docs/measurements.md)."""

NOWHERE: Final = 0.1
"""S in a view below which its silhouette is of something else than the body, unless its landmarks
are the body's: it is 0.5 at least in all frames of four performers (docs/measurements.md)."""

LOST_S: Final = 1.0 / 3.0
"""Duration without belief, seconds, after which the body is lost: five frames at 15 Hz. Until
then it is predicted: it has a pose, with confidence 0."""


def weighed(
    person: Following,
    now: Sighting,
    scores: tuple[float, ...],
    period_s: float,
    *,
    before: Person = Waiting(),
    on_floor: bool = True,
) -> Following:
    """The person with the duration of disbelief; a body lost in both views is forgotten.

    A frame in which the user placed joints is believed. Without forgetting, the network would
    continue from its memory of a wrong body. A single view keeps its memory, which alone
    distinguishes front from back. A body that was never believed is lost at once, as nothing shows
    that it is a person. Instead of a pose that no body takes the one before is carried on; without
    one the body is lost at once.

    Args:
        person: Of this instant.
        now: The views of the instant.
        scores: S of the pose in each view.
        period_s: Time between frames.
        before: Of the instant before.
        on_floor: The rig's floor is known: a body that no jump lifts so high is not believed.
    """
    found, placed = person.found, now.annotations.joints_px
    places_m, detections = person.places_m(found.pose), now.instant.detections
    possible = is_possible(person, now, on_floor=on_floor)
    if placed or (possible and is_believed(places_m, now.filed_rig, detections, scores)):
        return person._replace(doubted=0, ever_confirmed=True)
    lost = lost_frames(period_s)
    is_unknown = found.alone is not None and not person.ever_confirmed
    if not possible and isinstance(before, Following):
        person, possible = person._replace(found=before.found), True
    least = 1 if possible and not is_unknown else lost
    person = person._replace(doubted=max(least, person.doubted + 1))
    if person.doubted % lost or found.alone is not None:
        return person
    return person._replace(found=person.found._replace(memory=None))


def is_possible(person: Following, now: Sighting, *, on_floor: bool) -> bool:
    """Whether a body can take the pose; who stands high up on something is shown there by the
    landmarks of two views."""
    places_m = person.places_m(person.found.pose)
    if not has_possible_limbs(places_m, stature(person.body.bdp)):
        return False
    if not on_floor or is_within_a_jump(places_m):
        return True
    views = zip(now.instant.detections, now.filed_rig.cameras, strict=True)
    return sum(_is_near(places_m, camera, seen) for seen, camera in views) > 1


def _is_near(joints_m: NDArray[np.float64], camera: Camera, seen: Observation | None) -> bool:
    """Whether a view's landmarks are trusted and stand where a body does."""
    shown = None if seen is None else seen.landmarks
    return shown is not None and _is_trusted(shown) and _astray(joints_m, camera, shown) <= ASTRAY


def status_of(person: Following, period_s: float) -> Status:
    """The status, from presence, the opening posture and belief: never from S alone (M25).

    A person partly outside the only picture is tracked: the joints outside have confidence 0.
    """
    if person.doubted:
        return "lost" if person.doubted >= lost_frames(period_s) else "predicted"
    return "measuring" if person.body.under_way else "tracking"


def lost_frames(period_s: float) -> int:
    """Number of instants in a row without belief after which a body is lost."""
    return max(1, round(LOST_S / period_s))


def is_believed(
    joints_m: NDArray[np.float64], rig: Rig, seen: Seen, scores: tuple[float, ...]
) -> bool:
    """Whether the views confirm a body; of views with trusted landmarks, two must. A view in which
    it is nowhere is outvoted by two others.

    Args:
        joints_m: (15, 3) world, JOINT_NAMES.
        rig: The cameras.
        seen: The person in each view.
        scores: S of the body in each view.
    """
    views = [
        (person, camera, score)
        for person, camera, score in zip(seen, rig.cameras, scores, strict=True)
        if person is not None
    ]
    told = [
        (person.landmarks, camera)
        for person, camera, _ in views
        if person.landmarks is not None and _is_trusted(person.landmarks)
    ]
    if max(scores) < LOST_SCORE and len(told) < 2:
        return False
    elsewhere = sum(
        score < NOWHERE and not _is_near(joints_m, camera, person)
        for person, camera, score in views
    )
    if elsewhere and len(views) - elsewhere < 2:
        return False
    if told:
        near = sum(_astray(joints_m, camera, shown) <= ASTRAY for shown, camera in told)
        return near >= min(2, len(told)) and not _is_turned_about(joints_m, told)
    unsure = [person.landmarks for person, _, _ in views if person.landmarks is not None]
    if len(unsure) < len(views):
        return True
    shows_person = max(_sure(landmarks) for landmarks in unsure) >= NOBODY
    return shows_person and min(score for _, _, score in views) >= UNTRUSTED_SCORE


def _is_trusted(found: Landmarks) -> bool:
    sure = sum(each > SURE for each in found.confidence)
    return _sure(found) >= TRUSTED and sure >= LEAST


def _sure(found: Landmarks) -> float:
    """Mean confidence of the landmarks."""
    return sum(found.confidence) / len(found.confidence)


def _astray(joints_m: NDArray[np.float64], camera: Camera, found: Landmarks) -> float:
    """Median distance of the sure landmarks from a body's joints, in its heights.

    Left and right may be exchanged: the facing is tested separately.
    """
    joints_px, seen_px = project(camera, joints_m), np.array(found.joints_px)
    if np.isnan(joints_px).any():  # the body is behind the camera that sees the person
        return np.inf
    across_px, up_px = (joints_px.max(axis=0) - joints_px.min(axis=0)).tolist()
    tall_px = max(math.hypot(across_px, up_px), 1.0)
    sure = np.array(found.confidence) > SURE
    off_px = np.stack([joints_px, joints_px[OTHER_SIDE]])[:, sure] - seen_px[sure]
    off_px = np.sort(np.hypot(off_px[..., 0], off_px[..., 1]), axis=1)
    return float(off_px[:, off_px.shape[1] // 2].min()) / tall_px


def _is_turned_about(joints_m: NDArray[np.float64], told: list[tuple[Landmarks, Camera]]) -> bool:
    """Whether all views that are sure of the facing disagree with the body's.

    A single view confuses front and back too often.
    """
    off_deg = [
        _off_deg(yaw_deg(camera, joints_m), shown.facing_deg)
        for shown, camera in told
        if shown.facing_confidence > FACES
    ]
    return len(off_deg) > 1 and min(off_deg) > TURNED_DEG


def _off_deg(one_deg: float, other_deg: float) -> float:
    return abs((one_deg - other_deg + 180.0) % 360.0 - 180.0)
