"""The 15 postures as motions: joint angles over time, each in a person's own style."""

from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.motion.falling import FALL_S, Fall, fall, fallen, lain
from synth.motion.footing import posed
from synth.motion.moves import MOTION_S, MOVES, Move, Track, smooth
from synth.motion.roaming import FREE_S, roaming
from synth.person.people import Person, Style, take_style
from synth.person.skeleton import ANGLES

POSTURES: Final = tuple(MOVES)
"""The 15 names of design.md 3, in its order."""

EMPTY, TPOSE, LOWERING, MOTION = 0, 1, 2, 3
"""Phases of a clip: `phase` in `truth.npz`."""

OPENING_S: Final = (9 / 15, 14 / 15, 6 / 15)
"""Durations of the empty room, of the T pose, and of lowering the arms."""
RAMP_S: Final = 0.25
"""Time in which a repeated movement begins, and ends."""
LASTS_S: Final = {"free": FREE_S, "fall": FALL_S}
"""Duration of the motions that are no posture."""
SWAY_HZ: Final = (0.35, 0.6, 1.1)
"""Frequencies of the involuntary sway."""
SWAY_SHARE: Final = {
    "foot": 0.0,
    "elbow": 0.7,
    "knee": 0.3,
    "root": 0.25,
    "hip": 0.25,
    "torso": 0.4,
}
"""Amplitude of a joint's sway in units of `jit`; 0.6 where none is given."""


class Act(NamedTuple):
    """One performance within a take."""

    name: str
    first: int
    """Frames in which the body left its stance and returned to it."""
    last: int


class Motion(NamedTuple):
    """A person's motion in a clip, frame by frame."""

    posture: str
    fps: float
    joints_m: NDArray[np.float64]
    """(n, 20, 3) world, order of JOINTS; NaN while the room is empty."""
    bones: NDArray[np.float64]
    """(n, bones, 3, 4), order of BONES; the empty frames hold the first pose."""
    angles_deg: NDArray[np.float64]
    """(n, 27), order of ANGLES; NaN while the room is empty."""
    root_m: NDArray[np.float64]
    """(n, 3) places of the pelvis; NaN while the room is empty."""
    phase: NDArray[np.uint8]
    style: Style
    """Style of this take."""
    acts: tuple[Act, ...] = ()
    """The performances of a take that holds several."""

    @property
    def present(self) -> NDArray[np.bool_]:
        """Whether a person is in the room, (n,)."""
        return self.phase != EMPTY


def performance(
    someone: Person, posture: str, seed: int, fps: float = 15.0, motion_s: float = 0.0
) -> Motion:
    """One take: the empty room, a T-pose, arms down, then the posture.

    Args:
        someone: The performer.
        posture: One of POSTURES; "free": turning and moving at random; "fall": the same, with a
            fall, lying and getting up again.
        seed: Seed of the take.
        fps: Frames per second.
        motion_s: Duration for which the posture is repeated; 0: once, as in a set.

    Raises:
        ValueError: When the posture is unknown.
    """
    if posture not in (*LASTS_S, *MOVES):
        raise ValueError(
            f"unknown posture {posture!r}; known are {', '.join((*LASTS_S, *POSTURES))}"
        )
    rng = np.random.default_rng([someone.seed, seed, *posture.encode()])
    style = take_style(someone.style, rng)
    lasts = (*OPENING_S, motion_s or LASTS_S.get(posture, MOTION_S))
    phase = np.repeat(np.arange(4, dtype=np.uint8), [round(s * fps) for s in lasts])
    time_s = (np.arange(len(phase)) - int((phase < MOTION).sum())) / fps
    if posture in MOVES:
        time_s = np.where(time_s > 0.0, time_s % MOTION_S, time_s)
    still = stance(style, time_s)
    leash = None
    if posture in MOVES:
        moved = performed(MOVES[posture], still, time_s, style)
    else:
        moved, leash = roaming(still, time_s, rng)
    if posture == "fall":
        moved = lain(moved, np.stack([still[name] for name in ANGLES], axis=1), time_s)
    angles_deg = opened(moved, phase, fps) + sway(style, time_s, rng)
    falls = fall(time_s, rng) if posture == "fall" else None
    return staged(someone, Course(posture, fps, angles_deg, phase, style, leash, falls))


class Course(NamedTuple):
    """Joint angles of a take."""

    posture: str
    fps: float
    angles_deg: NDArray[np.float64]
    """(n, 27), for all frames."""
    phase: NDArray[np.uint8]
    """(n,) phase of each frame: EMPTY and so on."""
    style: Style
    leash: Vector | None
    """(n, 2) places that attract the pelvis; None: none, and the way is centred."""
    falls: Fall | None = None
    """The fall; None: they stay upright."""


def staged(someone: Person, course: Course) -> Motion:
    """A take from the joint angles of all its frames: feet on the floor, in the room's middle."""
    posture, fps, angles_deg, phase, style, leash, falls = course
    start = np.array([style.x0, style.z0])
    body = posed(someone.measures, angles_deg, start, leash)
    if leash is None:
        path = body.joints_m[:, 0, [0, 2]] - start
        centred = start - (path.max(axis=0) + path.min(axis=0)) / 2
        body = posed(someone.measures, angles_deg, centred)
    if falls is not None:
        body = fallen(body, falls)
    empty = phase == EMPTY
    joints, root, angles = body.joints_m, body.joints_m[:, 0].copy(), angles_deg.copy()
    for array in (joints, root, angles):
        array[empty] = np.nan
    return Motion(posture, fps, joints, body.bones, angles, root, phase, style)


def stance(s: Style, t: Vector) -> Track:
    """The stance of an idle person."""
    still = dict.fromkeys(ANGLES, np.zeros_like(t))
    level = {
        "sh_abd": s.carry,
        "sh_flex": 4.0,
        "sh_twist": -12.0,
        "elbow": s.elbow,
        "hip_abd": s.stance,
        "hip_flex": 2.5,
        "hip_twist": s.toe,
        "knee": 4.5,
    }
    for name, value in level.items():
        still[f"l_{name}"] = np.full_like(t, value)
        still[f"r_{name}"] = np.full_like(t, value)
    still["torso_pitch"] = np.full_like(t, s.lean)
    still["head_pitch"] = np.full_like(t, s.headp - s.lean)
    still["root_yaw"] = np.full_like(t, s.yaw)
    return still


def performed(
    move: Move, still: Track, t: Vector, s: Style, lasts_s: float = MOTION_S
) -> NDArray[np.float64]:
    """Angles (n, 27) of a movement that eases in and out of the stance, the left arm with its
    delay."""
    ease = smooth(t / RAMP_S) * smooth((lasts_s - t) / RAMP_S)
    on_time, late = move(t, s, still), move(t - s.delay, s, still)
    columns = []
    for name in ANGLES:
        left_arm = name.startswith(("l_sh", "l_elbow"))
        moved = (late if left_arm else on_time).get(name, still[name])
        larger = 1.0 + s.asym if left_arm else 1.0
        columns.append(still[name] + ease * larger * (moved - still[name]))
    return np.stack(columns, axis=1)


def opened(moved: NDArray[np.float64], phase: NDArray[np.uint8], fps: float) -> NDArray[np.float64]:
    """The opening before the motion: arms out, then down."""
    at = int((phase < LOWERING).sum())
    frames = np.arange(len(phase), dtype=np.float64)
    down = smooth((frames - at + 0.5) / (fps * OPENING_S[2]))
    angles = moved.copy()
    for side in "lr":
        for name, out in (("sh_abd", 89.0), ("sh_flex", 0.0), ("sh_twist", 0.0), ("elbow", 4.5)):
            column = ANGLES.index(f"{side}_{name}")
            angles[:, column] = out + down * (angles[:, column] - out)
    return angles


def sway(s: Style, t: Vector, rng: np.random.Generator) -> NDArray[np.float64]:
    """The involuntary sway, (n, 27)."""
    columns = []
    for name in ANGLES:
        share = next((v for key, v in SWAY_SHARE.items() if key in name), 0.6)
        turns, sizes = rng.random(len(SWAY_HZ)), rng.normal(0.0, 0.5, len(SWAY_HZ))
        waves = np.sin(2 * np.pi * (np.outer(t, SWAY_HZ) + turns))
        columns.append(share * s.jit * waves @ sizes)
    return np.stack(columns, axis=1)


Movement = Literal["walking", "arm_raising", "arm_swing", "squatting", "kicking", "free"]

_FIVE: Final[dict[str, Movement]] = {
    "walk": "walking",
    "raise": "arm_raising",
    "swing": "arm_swing",
    "squat": "squatting",
    "kick": "kicking",
    "free": "free",
    "fall": "free",
    "stream": "free",
    "scene": "free",
    "spot": "free",
}


def movement(posture: str) -> Movement:
    """The paper's movement to which a posture belongs; "free": none."""
    return _FIVE[posture.split("_", maxsplit=1)[0]]
