"""A video's bodies, smoothed with later frames too, and with rigid limbs."""

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector
from common.body.extremities import extremities
from common.body.observation import Pixel
from common.body.proportions import stature
from common.bus.messages import Body
from common.notes.notes import Notes, held
from common.rig.camera import Camera, Rig, centre, project
from common.rig.upright import Upright, Uprights
from integrator.outgoing import filed_pixels, points
from integrator.single.rigid_limbs import with_lengths
from runtime.unfinished.work import Kept

NOISE_M: Final = 0.05
"""Standard deviation of a joint in a single view."""
ACCELERATION_M_S2: Final = 40.0
"""Standard deviation of a joint's acceleration between two frames. Of 20, 30, 40 and 60 the
errors are least with 20 at the recorded pace, with 60 at twice that pace; 40 is within 1 % of
both. Two performers and six synthetic people in free motion, by `steadied`
(docs/measurements.md)."""
START_SPEED_M_S: Final = 2.0
"""Standard deviation of the speed at the first frame: a limb may be moving already."""
ROUNDS: Final = 3
"""Number of smoothing rounds, each with less weight for outliers."""

Covariance = tuple[Vector, Vector, Vector]
"""Covariance of place, of place and speed, of speed: the same for all axes of a joint, m and s."""


def calmed(
    bodies: Sequence[Body],
    rig: Rig,
    notes: Notes = Notes(),
    kept: Kept | None = None,
    uprights: Uprights = (None, None),
) -> Sequence[Body]:
    """The bodies of a video with smooth joints, whose limbs keep their median lengths.

    Where a length deviates, depth is changed more than the place in the picture. Nose, heels, toes
    and knuckles go with their joints: by the body's rule, and by how far off it they were measured.

    Angles are not changed: they were smoothed as they came. Neither are joints that the user
    placed.

    Args:
        bodies: In the order of time; those without joints separate stretches.
        rig: The video's camera, twice.
        notes: The user's inputs.
        kept: Receives the bodies; None: a list.
        uprights: How each view's picture comes from its file's.
    """
    from animator.skeleton.bone_turns import motion_of
    from animator.skeleton.bones import joints_of, skeleton_of

    stretches = [_of_stretch(some) for seen, some in groupby(bodies, _is_posed) if seen]
    if not stretches:
        return bodies
    joints_m, off_rule_m = (np.concatenate(each) for each in zip(*stretches, strict=True))
    skeleton = skeleton_of(joints_m)
    time_s = np.array([body.captured_s for body in bodies if body.joints_m])
    rigid_m = joints_of(skeleton, motion_of(skeleton, joints_m, time_s))
    rigid_m = with_lengths(joints_m, rigid_m, centre(rig.cameras[0]))
    calm_m = iter(zip(rigid_m, off_rule_m, strict=True))
    calm: Kept = [] if kept is None else kept
    views = [*zip(rig.cameras, uprights, strict=True)]
    for body in bodies:
        calm.append(_with(body, *next(calm_m), views, notes) if body.joints_m else body)
    return calm


def steadied(joints_m: NDArray[np.float64], time_s: Vector) -> NDArray[np.float64]:
    """Smooth joints over time; outliers, far from their smooth place, get little weight.

    A joint that jumps to the other side, or to an object, and back would pull its neighbours with
    it, as it exceeds the usual noise. Least squares, reweighted by Cauchy's 1 / (1 + r^2 / c^2).

    Args:
        joints_m: (n, 15, 3)
        time_s: (n,) increasing.
    """
    usual = NOISE_M**2
    variances = np.full((*joints_m.shape[:-1], 1), usual)
    for _ in range(ROUNDS):
        off = joints_m - smoothed(joints_m, time_s, variances)
        variances = usual + (off**2).mean(axis=-1, keepdims=True)
    return smoothed(joints_m, time_s, variances)


def smoothed(
    places_m: NDArray[np.float64], time_s: Vector, variances: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Smoothed places over time: constant velocity with unknown accelerations.

    A Kalman filter forwards, then the smoother of Rauch, Tung and Striebel (1965) backwards, for
    all places at once: filterpy's, joint by joint, would take 20 times as long.

    Args:
        places_m: (n, ...)
        time_s: (n,) increasing.
        variances: (n, ...) m^2 of the places, of their shape or of length 1 along an axis.
    """
    found_m, speed_m_s = places_m.copy(), np.zeros_like(places_m)
    P: Covariance = (variances[0], 0.0 * variances[0], START_SPEED_M_S**2 + 0.0 * variances[0])
    known, gaps_s = [P], np.diff(time_s).tolist()
    x, v = found_m[0], speed_m_s[0]
    for n, dt_s in enumerate(gaps_s, 1):
        a, b, c = _ahead(P, dt_s)
        gain, speed_gain = a / (a + variances[n]), b / (a + variances[n])
        off = places_m[n] - (x + dt_s * v)
        x, v = x + dt_s * v + gain * off, v + speed_gain * off
        P = (a - gain * a, b - gain * b, c - speed_gain * b)
        known.append(P)
        found_m[n], speed_m_s[n] = x, v
    for n in range(len(gaps_s) - 1, -1, -1):
        (gain_x, gain_v), dt_s = _gains(known[n], gaps_s[n]), gaps_s[n]
        x0, v0 = found_m[n], speed_m_s[n]
        dx, dv = x - (x0 + dt_s * v0), v - v0
        x, v = x0 + gain_x[0] * dx + gain_x[1] * dv, v0 + gain_v[0] * dx + gain_v[1] * dv
        found_m[n] = x
    return found_m


def _ahead(P: Covariance, dt_s: float) -> Covariance:
    """The covariance after some time."""
    (a, b, c), q = P, ACCELERATION_M_S2**2
    a = a + 2 * dt_s * b + dt_s**2 * c + q * dt_s**4 / 4
    return a, b + dt_s * c + q * dt_s**3 / 2, c + q * dt_s**2


def _gains(P: Covariance, dt_s: float) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector]]:
    """Gains with which a later correction of place and speed changes the earlier ones."""
    (a, b, c), (A, B, C) = P, _ahead(P, dt_s)
    whole, beside = A * C - B * B, b + dt_s * c
    of_place = (((a + dt_s * b) * C - b * B) / whole, (b * A - (a + dt_s * b) * B) / whole)
    return of_place, ((beside * C - c * B) / whole, (c * A - beside * B) / whole)


def _is_posed(body: Body) -> bool:
    return bool(body.joints_m)


def _of_stretch(bodies: Iterable[Body]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The joints, (n, 15, 3), and the extremities off the body's rule, (n, 7, 3), both smooth."""
    every = [*bodies]
    time_s = np.array([body.captured_s for body in every])
    joints_m = np.array([body.joints_m for body in every])
    off_m = [_off_rule(body, each) for body, each in zip(every, joints_m, strict=True)]
    return steadied(joints_m, time_s), steadied(np.array(off_m), time_s)


def _off_rule(body: Body, joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far the extremities are from where the body's rule has them, (7, 3)."""
    return np.asarray(np.array(body.extremities_m) - _by_rule(body, joints_m))


def _by_rule(body: Body, joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    assert body.bdp is not None
    return extremities(joints_m, stature(body.bdp))


def _with(
    body: Body,
    joints_m: NDArray[np.float64],
    off_rule_m: NDArray[np.float64],
    views: Sequence[tuple[Camera, Upright | None]],
    notes: Notes,
) -> Body:
    for name in held(notes, body.frame).joints_px:
        at = JOINT_NAMES.index(name)
        joints_m[at] = body.joints_m[at]
    ends_m = _by_rule(body, joints_m) + off_rule_m
    return msgspec.structs.replace(
        body,
        joints_m=points(joints_m),
        joints_px=_pixels(joints_m, views),
        extremities_m=points(ends_m),
        extremities_px=_pixels(ends_m, views),
    )


def _pixels(
    places_m: NDArray[np.float64], views: Sequence[tuple[Camera, Upright | None]]
) -> tuple[tuple[Pixel, ...], ...]:
    return tuple(filed_pixels(project(camera, places_m), upright) for camera, upright in views)
