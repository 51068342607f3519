"""Feet that do not slide: where a foot stands it is held, and the leg follows by its two bones."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.bones import Joints, Skeleton
from animator.foot_contact import SIDES, Stance, stances
from animator.turns import axes_of
from common.body.body import Vector
from common.body.extremities import ALL_JOINT_NAMES
from common.nearest_rows import nearest

Floats = NDArray[np.float64]

FARTHEST_M: Final = 0.03
"""No foot is moved by more: one that was measured farther from where it stands follows, and slides.
On r01 and r04 one contact in seven does."""
BLEND_S: Final = 0.2
"""So long before and after it stands a foot goes over to where it was measured."""
LIFT_M: Final = 0.05
"""No body is moved by more so that its legs reach the floor."""
KNEE_SHARE: Final = 0.3
"""How much of its ankle's way a free knee goes along: by the lengths of its bones it would jump,
since a straight leg that is a centimetre too long bends by 18 degrees."""
GIVES_M: Final = 0.015
"""By so much a skeleton's foot stands higher or lower than it did, rather than that its knee bends:
the tracked ankle's own height varies by 8 mm while it stands."""
STEEP: Final = 0.5
"""A leg that stands less upright, by its cosine, is not taken at its word."""
DAMPING: Final = 6.0
"""How reluctantly the body moves instead: with less all of it is farther off the joints that were
tracked, with more standing feet rise and sink. Chosen on r01 and r04, as what is above."""

_AT: Final = {name: i for i, name in enumerate(ALL_JOINT_NAMES)}


class Planted(NamedTuple):
    """A run whose feet stand still."""

    joints_m: Joints
    held: Floats
    """(n, 2) of the left and the right foot: 1 while it stands, less while it comes and goes."""


def planted(joints_m: Joints, time_s: Vector) -> Planted:
    """The run with each standing foot where it mostly was, and the knees to that.

    Args:
        joints_m: (n, 15 or 22, 3), NaN where there is no pose.
        time_s: (n,) increasing.
    """
    moved, held = joints_m.copy(), np.zeros((len(joints_m), 2))
    if len(joints_m) < 2:
        return Planted(moved, held)
    found = stances(joints_m, time_s)
    for foot, side in enumerate(SIDES):
        own = [stance for stance in found if stance.side == side]
        held[:, foot] = _weights(own, time_s)
        for part in ("ankle", "heel", "toe"):
            at = _AT[f"{side}_{part}"]
            if at < joints_m.shape[1]:
                moved[:, at] += _shifts(joints_m[:, at], own, held[:, foot])
        knee, ankle = _AT[f"{side}_knee"], _AT[f"{side}_ankle"]
        moved[:, knee] += KNEE_SHARE * (moved[:, ankle] - joints_m[:, ankle])
    return Planted(moved, held)


def knees(leg_m: Floats, thigh_m: Floats, shank_m: Floats) -> Floats:
    """Where knees are, (n, 3), so that both bones have their lengths and bend as they did.

    A leg that is too short is straight, its knee where the shares of its bones are.

    Args:
        leg_m: (n, 3, 3) hip, knee as it was, ankle.
        thigh_m: (n,) or a number.
        shank_m: Likewise.
    """
    hip, knee, ankle = leg_m.swapaxes(0, 1)
    along, far_m = _unit(ankle - hip)
    reach_m = thigh_m + shank_m
    near_m = np.clip(far_m, np.abs(thigh_m - shank_m) + 1e-6, reach_m)
    foot_m = (thigh_m**2 - shank_m**2 + near_m**2) / (2.0 * near_m)
    aside_m = np.sqrt(np.maximum(thigh_m**2 - foot_m**2, 0.0))
    bend = knee - hip
    bend, _ = _unit(bend - (bend * along).sum(axis=1, keepdims=True) * along)
    stretch = np.maximum(far_m / reach_m, 1.0)
    found: Floats = hip + (foot_m * stretch)[:, None] * along + aside_m[:, None] * bend
    return found


def on_its_feet(skeleton: Skeleton, run: Planted) -> Joints:
    """The joints to which a skeleton of fixed bones is aimed so that its feet stand still too.

    The body is shifted so that the legs, with their knees bent as measured, reach the feet that
    stand; of what is left feet take GIVES_M by standing higher or lower, and knees the rest.

    Args:
        skeleton: Of the run.
        run: Rows with a pose.
    """
    joints_m, held = run.joints_m.copy(), run.held
    feet = [_AT[f"{side}_{part}"] for side in SIDES for part in ("ankle", "heel", "toe")]
    rest = [i for i in range(joints_m.shape[1]) if i not in feet]
    names = [bone.name for bone in skeleton.bones]
    lengths = np.linalg.norm(skeleton.tips_m, axis=1)
    legs = [
        (lengths[names.index(f"{side}UpLeg")], lengths[names.index(f"{side}Leg")])
        for side in ("Left", "Right")
    ]
    for _ in range(2):
        joints_m[:, rest] += _lift(_hips(skeleton, joints_m), run, joints_m, legs)[:, None]
    hips = _hips(skeleton, joints_m)
    for foot, side in enumerate(SIDES):
        knee, ankle = _AT[f"{side}_knee"], _AT[f"{side}_ankle"]
        along, now_m = _unit(joints_m[:, ankle] - hips[foot])
        lack_m = (_reach(run, foot, legs[foot]) - now_m) / np.minimum(along[:, 1], -STEEP)
        joints_m[:, ankle, 1] += held[:, foot] * np.clip(lack_m, -GIVES_M, GIVES_M)
        leg = np.stack([hips[foot], joints_m[:, knee], joints_m[:, ankle]], axis=1)
        bent = knees(leg, *legs[foot])
        joints_m[:, knee] += held[:, foot, None] * (bent - joints_m[:, knee])
    return joints_m


def _hips(skeleton: Skeleton, joints_m: Joints) -> Floats:
    """Where the skeleton's hips are, (2, n, 3)."""
    at = {name: joints_m[:, _AT[name]] for name in ("pelvis", "neck", "l_hip", "r_hip")}
    axes = axes_of(at["neck"] - at["pelvis"], at["l_hip"] - at["r_hip"], keep="across")
    aside = axes @ skeleton.tips_m[0]
    return np.stack([at["pelvis"] + aside, at["pelvis"] - aside])


def _lift(hips: Floats, run: Planted, joints_m: Joints, legs: list[tuple[float, float]]) -> Floats:
    """By how much to shift the body, (n, 3): least squares of what the standing legs lack."""
    rows, lacks = [], []
    for foot, side in enumerate(SIDES):
        far_m = _reach(run, foot, legs[foot])
        along, now_m = _unit(hips[foot] - joints_m[:, _AT[f"{side}_ankle"]])
        rows.append(run.held[:, foot, None] * along)
        lacks.append(run.held[:, foot] * (far_m - now_m))
    jacobian, lack = np.stack(rows, axis=1), np.stack(lacks, axis=1)
    normal = jacobian @ jacobian.swapaxes(1, 2) + DAMPING * np.eye(2)
    shift = (jacobian.swapaxes(1, 2) @ np.linalg.solve(normal, lack[..., None]))[..., 0]
    return _bounded(shift, LIFT_M)


def _reach(run: Planted, foot: int, leg: tuple[float, float]) -> Vector:
    """How far a skeleton's ankle is from its hip where the knee bends as measured, (n,)."""
    hip, knee, ankle = (
        run.joints_m[:, _AT[f"{SIDES[foot]}_{name}"]] for name in ("hip", "knee", "ankle")
    )
    thigh, shank = leg
    bend = (_unit(hip - knee)[0] * _unit(ankle - knee)[0]).sum(axis=1)
    found: Vector = np.sqrt(thigh**2 + shank**2 - 2 * thigh * shank * bend)
    return found


def _weights(own: list[Stance], time_s: Vector) -> Vector:
    """(n,) 1 in a stance, falling to 0 within BLEND_S beside it."""
    weights = np.zeros(len(time_s))
    for stance in own:
        first_s, last_s = time_s[stance.first], time_s[stance.end - 1]
        rows = slice(*np.searchsorted(time_s, (first_s - BLEND_S, last_s + BLEND_S)))
        since = np.maximum(first_s - time_s[rows], time_s[rows] - last_s)
        fall = np.clip(1.0 - np.maximum(since, 0.0) / BLEND_S, 0.0, 1.0)
        weights[rows] = np.maximum(weights[rows], fall * fall * (3.0 - 2.0 * fall))
    return weights


def _shifts(places_m: Floats, own: list[Stance], weights: Vector) -> Floats:
    """By how much a point of a foot is moved, (n, 3)."""
    stands, shifts = np.zeros(len(places_m), np.bool_), np.zeros_like(places_m)
    for stance in own:
        part = slice(stance.first, stance.end)
        stands[part] = True
        shifts[part] = _bounded(np.median(places_m[part], axis=0) - places_m[part], FARTHEST_M)
    if not own:
        return shifts
    rows = nearest(np.arange(len(places_m)), np.flatnonzero(stands))
    return np.asarray(weights[:, None] * shifts[rows])


def _bounded(shifts: Floats, most_m: float) -> Floats:
    lengths = np.linalg.norm(shifts, axis=1, keepdims=True)
    return np.asarray(shifts * np.minimum(1.0, most_m / np.maximum(lengths, 1e-12)))


def _unit(along: Floats) -> tuple[Floats, Floats]:
    """Unit vectors and lengths of (n, 3)."""
    lengths = np.linalg.norm(along, axis=1)
    return along / np.maximum(lengths, 1e-9)[:, None], lengths
