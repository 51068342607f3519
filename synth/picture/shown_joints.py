"""Joints with a simulated landmark network's errors and confidence: without pictures.

The constants below are errors by confidence, their duration, and confidence of hidden joints, all
measured of the packaged network on synthetic people in pictures.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, OTHER_SIDE, Vector
from common.rig.camera import Camera, arrays_of, project

PARTS: Final = (
    ("pelvis", "neck", 0.075),
    ("l_shoulder", "l_hip", 0.05),
    ("r_shoulder", "r_hip", 0.05),
    ("neck", "head_top", 0.055),
    *(
        (f"{side}_{upper}", f"{side}_{lower}", thick)
        for side in "lr"
        for upper, lower, thick in (
            ("shoulder", "elbow", 0.028),
            ("elbow", "wrist", 0.024),
            ("hip", "knee", 0.045),
            ("knee", "ankle", 0.032),
        )
    ),
)
"""Occluding body parts: both ends, and thickness, in statures."""
TRUNK: Final = 3
"""Number of body parts that make up the trunk."""
ENDS: Final = np.array([[JOINT_NAMES.index(end) for end in part[:2]] for part in PARTS])
THICK: Final = np.array([part[2] for part in PARTS])
ALONG: Final = np.linspace(0.1, 0.9, 5)[:, None]
BEFORE: Final = 0.05
"""Smallest distance of an occluding part before a joint, statures."""
ON_TRUNK: Final = np.array([name in ("pelvis", "neck", "head_top") for name in JOINT_NAMES])
ON_ARM: Final = np.array(["elbow" in name or "wrist" in name for name in JOINT_NAMES])
GIRDLES: Final = [
    JOINT_NAMES.index(name) for name in ("l_shoulder", "r_shoulder", "l_hip", "r_hip")
]
LEGS: Final = np.where(
    ["knee" in n or "ankle" in n or "hip" in n for n in JOINT_NAMES],
    OTHER_SIDE,
    np.arange(len(JOINT_NAMES)),
)
"""Index of the other side's joint for legs, else of the same joint."""

SURE: Final = (2.5, 0.6)
"""Logit of the confidence in a visible joint: mean and deviation between people."""
SURER_TRUNK, LESS_ARM = 1.0, 0.3
HIDDEN: Final = (2.4, 0.6)
"""Loss of that for a hidden one."""
OUTSIDE: Final = -3.0
"""Logit for one outside the picture."""
JOINT_DEV, MOMENT_DEV, LASTS = 0.3, 0.8, 0.8
"""Deviations between joints and over time; the share that persists from instant to instant."""
OFF: Final = (
    (0.0, 0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95, 1.0),
    (0.16, 0.13, 0.08, 0.05, 0.036, 0.029, 0.025, 0.0195, 0.016, 0.0123, 0.0078, 0.006),
)
"""Standard deviation of a joint's error each way, in statures, by its confidence."""
OFF_LASTS, STEADY = 0.75, 0.006
"""Share of an error that persists from instant to instant, and the constant part."""
DOUBTED, ASTRAY = 0.8, 1.3
"""Threshold of a normal variable above which a hidden or unsure joint is exchanged with the
other side's for a while."""
FACING: Final = (3.0, 8.0)
"""Error of the facing, degrees: constant, and over time."""
TURNED, LEGS_EXCHANGED, UNTOLD = 0.06, 0.08, 0.1
"""Shares of performances in which, for a while, front and back are exchanged, only the legs are,
or the facing is unknown."""
ALL_THROUGH: Final = 0.3
"""Share of the exchanged ones that are so throughout."""
STRETCH: Final = (5, 40)
"""Duration of such a while, instants."""


class ShownJoints(NamedTuple):
    """Landmarks of one camera over time."""

    joints_px: NDArray[np.float64]
    """(n, 15, 2)"""
    confidence: NDArray[np.float64]
    """(n, 15)"""
    facing_deg: Vector
    """(n,) 0 towards the camera, 90 to the right of its picture."""
    facing_confidence: Vector
    """(n,)"""


def shown_joints(
    joints_m: NDArray[np.float64],
    camera: Camera,
    size: tuple[int, int],
    stature_m: float,
    rng: np.random.Generator,
) -> ShownJoints:
    """The landmarks of one camera for a performance.

    Args:
        joints_m: (n, 15, 3) JOINT_NAMES, world, all in front of the camera.
        camera: Without distortion.
        size: (width, height) of its picture.
        stature_m: The person's stature.
        rng: Source of all random values.
    """
    n, known = len(joints_m), arrays_of(camera)
    true_px = project(camera, joints_m.reshape(-1, 3)).reshape(n, -1, 2)
    scale_px = known.focal_px[0] * stature_m / (joints_m[:, 0] @ known.R[2] + known.t[2])
    hidden = hides(joints_m, known.centre, stature_m)
    outside = np.asarray(((true_px < 0) | (true_px > size)).any(axis=2))
    confidence = _confidence(hidden, outside, rng)
    others = (hidden | (confidence < DOUBTED)) & (_lasting(hidden.shape, 0.9, rng) > ASTRAY)
    places_px = np.clip(true_px, 0, size)
    places_px = np.where(others[..., None], places_px[:, OTHER_SIDE], places_px)
    off = np.exp(np.interp(confidence, OFF[0], np.log(OFF[1])))[..., None]
    off = off * _lasting(true_px.shape, OFF_LASTS, rng) + STEADY * rng.normal(
        size=true_px[:1].shape
    )
    facing_deg = _yaw_deg(joints_m, known.R) + FACING[0] * rng.normal()
    facing_deg += FACING[1] * _lasting((n,), LASTS, rng)
    told = _sigmoid(SURE[0] + SURE[1] * rng.normal() + MOMENT_DEV * _lasting((n,), LASTS, rng))
    exact = ShownJoints(places_px + off * scale_px[:, None, None], confidence, facing_deg, told)
    return _mistaken(exact, rng)


def _confidence(
    hidden: NDArray[np.bool_], outside: NDArray[np.bool_], rng: np.random.Generator
) -> NDArray[np.float64]:
    """(n, 15) joints that are hidden, or outside the picture."""
    logits = MOMENT_DEV * _lasting(hidden.shape, LASTS, rng)
    logits += SURE[0] + SURE[1] * rng.normal() + JOINT_DEV * rng.normal(size=hidden.shape[1])
    logits += SURER_TRUNK * ON_TRUNK - LESS_ARM * ON_ARM
    logits -= hidden * (HIDDEN[0] + HIDDEN[1] * rng.normal())
    return _sigmoid(np.where(outside, OUTSIDE, logits))


def hides(joints_m: NDArray[np.float64], eye_m: Vector, stature_m: float) -> NDArray[np.bool_]:
    """Which joints, (n, 15), another part of the body hides from a camera's place (3,)."""
    sights = joints_m - eye_m
    far_m = np.linalg.norm(sights, axis=2)
    sights = sights / far_m[..., None]
    starts, ends = joints_m[:, ENDS[:, 0], None], joints_m[:, ENDS[:, 1], None]
    places = starts + ALONG * (ends - starts) - eye_m
    along_m = np.einsum("npsc,njc->njps", places, sights)
    aside_m = np.sqrt(np.maximum((places**2).sum(axis=3)[:, None] - along_m**2, 0.0))
    before = along_m < (far_m - BEFORE * stature_m)[..., None, None]
    hit = ((aside_m < stature_m * THICK[:, None]) & before).any(axis=3)
    return np.asarray((hit & ~_own_parts()).any(axis=2))


def _own_parts() -> NDArray[np.bool_]:
    """(15, parts) the parts that a joint belongs to, which do not hide it."""
    own = (ENDS[None] == np.arange(len(JOINT_NAMES))[:, None, None]).any(axis=2)
    own[GIRDLES, :TRUNK] = True
    own[JOINT_NAMES.index("pelvis"), :TRUNK] = own[JOINT_NAMES.index("neck"), :TRUNK] = True
    return own


def _mistaken(shown: ShownJoints, rng: np.random.Generator) -> ShownJoints:
    """The same with exchanged sides, and unknown facings, for a while."""
    joints_px, confidence, facing_deg, told = shown
    n = len(joints_px)
    if rng.random() < TURNED:
        when = np.ones(n, np.bool_) if rng.random() < ALL_THROUGH else _while(n, rng)
        _exchange(joints_px, confidence, when, OTHER_SIDE)
        facing_deg[when] += 180.0
    if rng.random() < LEGS_EXCHANGED:
        _exchange(joints_px, confidence, _while(n, rng), LEGS)
    if rng.random() < UNTOLD:
        told[_while(n, rng)] *= 0.3
    return ShownJoints(joints_px, confidence, facing_deg, told)


def _exchange(
    joints_px: NDArray[np.float64],
    confidence: NDArray[np.float64],
    when: NDArray[np.bool_],
    others: NDArray[np.int_],
) -> None:
    """Replace joints by others in some instants."""
    joints_px[when] = joints_px[when][:, others]
    confidence[when] = confidence[when][:, others]


def _while(n: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    """(n,) True in a stretch of instants."""
    when, start = np.zeros(n, np.bool_), int(rng.integers(n))
    when[start : start + int(rng.integers(*STRETCH))] = True
    return when


def _yaw_deg(joints_m: NDArray[np.float64], R: NDArray[np.float64]) -> Vector:
    """Direction of shoulders and hips, (n,): 0 the camera, 90 the right of its picture."""
    left, right = joints_m[:, GIRDLES[::2]], joints_m[:, GIRDLES[1::2]]
    ahead = np.cross((left - right).sum(axis=1), [0.0, 1.0, 0.0]) @ R.T
    yaw_deg: Vector = np.degrees(np.arctan2(ahead[:, 0], -ahead[:, 2]))
    return yaw_deg


def _lasting(shape: tuple[int, ...], share: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Normal variables, correlated along the first axis by the given share."""
    found = rng.normal(size=shape)
    new = np.sqrt(1.0 - share * share)
    for i in range(1, shape[0]):
        found[i] = share * found[i - 1] + new * found[i]
    return found


def _sigmoid(logits: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(1.0 / (1.0 + np.exp(-logits)))
