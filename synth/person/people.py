"""Synthetic people: a body, a way of moving and clothes for every seed."""

import math
from typing import Final, Literal, NamedTuple, TypeVar

import numpy as np

from common.body.body import Vector

Sleeve = Literal["none", "short", "long"]
Hair = Literal["short", "bob", "tail", "bald"]
Pattern = Literal["plain", "hoops", "bars", "checks", "print"]
PATTERNS: Final[tuple[Pattern, ...]] = ("plain", "hoops", "bars", "checks", "print")
"""Patterns of shirts, in the order of the renderer's numbers."""

Choice = TypeVar("Choice")
Colour = tuple[int, int, int]
"""Blue, green, red; 0-255."""


class Style(NamedTuple):
    """A person's way of moving: nearly constant from take to take."""

    amp: float
    """Amplitude of all movements; 1 is the mean."""
    speed: float
    asym: float
    """Relative excess of the left side's movements over the right side's."""
    carry: float
    """Distance of the hanging arms from the trunk, degrees; degrees are the unit of all below
    without one."""
    elbow: float
    stance: float
    toe: float
    lean: float
    jit: float
    """Amplitude of the involuntary sway."""
    headp: float
    swing: float
    """Amplitude of arm swings; 1 is the mean."""
    raise_to: float
    both_to: float
    over: float
    yaw: float
    snap: float
    """Below 1 a movement starts fast, above 1 slowly."""
    cross: float
    """Inward motion of the arms when they swing or reach forward."""
    phase: float
    """Leading leg and phase of the cycle, in turns."""
    delay: float
    """Delay of the left side, seconds."""
    x0: float
    """Starting place, metres; so is z0."""
    z0: float


class Look(NamedTuple):
    """A person's clothes; looseness is in metres between limb and cloth."""

    sleeve: Sleeve
    shorts: bool
    hair: Hair
    pattern: Pattern
    pitch_m: float
    """Width of one stripe of the pattern."""
    loose_top_m: float
    loose_legs_m: float
    hem_m: float
    """Length of the shirt below the hip joints."""
    skin: Colour
    hair_colour: Colour
    shirt: Colour
    shirt_second: Colour
    trousers: Colour
    shoes: Colour


class Person(NamedTuple):
    """One performer."""

    seed: int
    name: str
    sex: Literal["m", "f"]
    measures: dict[str, float]
    """Metres, names as MEASURES; of the clothed body, joint to joint."""
    style: Style
    look: Look


MEASURES: Final[dict[str, tuple[float, float, float]]] = {
    "shoulder_width_m": (0.206, 0.194, 0.011),
    "hip_width_m": (0.127, 0.121, 0.007),
    "upper_arm_m": (0.156, 0.156, 0.006),
    "forearm_m": (0.147, 0.138, 0.007),
    "hand_m": (0.114, 0.112, 0.004),
    "thigh_m": (0.254, 0.254, 0.007),
    "shin_m": (0.243, 0.238, 0.009),
    "ankle_height_m": (0.043, 0.045, 0.002),
    "neck_to_headtop_m": (0.142, 0.146, 0.006),
    "waist_halfwidth_m": (0.094, 0.079, 0.013),
    "waist_halfdepth_m": (0.068, 0.056, 0.011),
    "chest_halfwidth_m": (0.102, 0.096, 0.007),
    "chest_halfdepth_m": (0.065, 0.064, 0.007),
    "hips_halfwidth_m": (0.100, 0.099, 0.006),
    "hips_halfdepth_m": (0.074, 0.070, 0.007),
    "upper_arm_radius_m": (0.029, 0.026, 0.004),
    "forearm_radius_m": (0.0205, 0.0182, 0.002),
    "thigh_radius_m": (0.058, 0.053, 0.008),
    "shin_radius_m": (0.037, 0.031, 0.008),
    "head_halfwidth_m": (0.049, 0.049, 0.002),
    "head_halfdepth_m": (0.064, 0.066, 0.01),
}
"""Shares of the stature: mean of men, mean of women, largest deviation. Chosen so that a dozen
people differ at least as much as the performers of the development clips do."""

MEASURE_NAMES: Final = ("stature_m", *MEASURES, "torso_m")

_GIRTHS: Final = tuple(n for n in MEASURES if "half" in n or "radius" in n)

STATURES_M: Final = {"m": (1.62, 1.94), "f": (1.50, 1.80)}

STYLE_RANGES: Final[dict[str, tuple[float, float]]] = {
    "amp": (0.84, 1.12),
    "speed": (0.82, 1.16),
    "asym": (-0.08, 0.08),
    "carry": (6.0, 13.0),
    "elbow": (7.0, 21.0),
    "stance": (3.0, 7.5),
    "toe": (6.0, 16.0),
    "lean": (-2.0, 4.0),
    "jit": (0.5, 1.9),
    "headp": (-4.0, 5.0),
    "swing": (0.8, 1.25),
    "raise_to": (86.0, 112.0),
    "both_to": (96.0, 142.0),
    "over": (146.0, 166.0),
    "yaw": (-4.0, 4.0),
    "snap": (0.65, 1.55),
    "cross": (2.5, 9.0),
    "phase": (0.0, 1.25),
    "delay": (0.0, 0.05),
    "x0": (-0.09, 0.09),
    "z0": (-0.07, 0.07),
}

TAKE_SHARE: Final = 0.12
"""Deviation of a take from the person's own style, as a share of the range of people."""

GOLDEN, PLASTIC = 0.618034, 0.754878
"""Steps of two sequences that fill [0, 1) evenly: even a dozen people cover short and tall, slim
and stout."""

_SKINS: Final[tuple[Colour, ...]] = (
    (160, 190, 232),
    (140, 172, 222),
    (110, 145, 205),
    (80, 112, 168),
    (55, 80, 128),
    (42, 60, 96),
)
_HAIRS: Final[tuple[Colour, ...]] = ((22, 22, 26), (30, 44, 70), (60, 110, 165), (110, 112, 118))


def person(seed: int) -> Person:
    """The performer of a seed, always the same."""
    rng = np.random.default_rng([seed, 0])
    sex: Literal["m", "f"] = "f" if seed % 2 else "m"
    style = Style(**{n: float(rng.uniform(*ends)) for n, ends in STYLE_RANGES.items()})
    return Person(seed, f"s{seed:02d}", sex, _measures(seed, sex, rng), style, _look(sex, rng))


def take_style(style: Style, rng: np.random.Generator) -> Style:
    """The style of one take: the person's own, with random deviations."""
    departed = {}
    for name, (low, high) in STYLE_RANGES.items():
        value = getattr(style, name) + TAKE_SHARE * (high - low) * rng.uniform(-1.0, 1.0)
        departed[name] = float(np.clip(value, low, high))
    return Style(**departed)


def measure_vector(someone: Person) -> Vector:
    """The measures in the order of MEASURE_NAMES, metres."""
    return np.array([someone.measures[name] for name in MEASURE_NAMES])


def _measures(seed: int, sex: Literal["m", "f"], rng: np.random.Generator) -> dict[str, float]:
    low, high = STATURES_M[sex]
    stature = low + (high - low) * math.fmod(0.5 + seed * GOLDEN, 1.0)
    build = 2.0 * math.fmod(0.5 + seed * PLASTIC, 1.0) - 1.0
    leg_or_trunk = float(rng.uniform(-1.0, 1.0))
    found = {"stature_m": stature}
    for name, (man, woman, departure) in MEASURES.items():
        own = float(rng.uniform(-1.0, 1.0))
        if name in _GIRTHS and not name.startswith("head"):
            own = 0.75 * build + 0.25 * own
        elif name in ("thigh_m", "shin_m"):
            own = 0.7 * leg_or_trunk + 0.3 * own
        found[name] = stature * ((man if sex == "m" else woman) + departure * own)
    legs = found["thigh_m"] + found["shin_m"] + found["ankle_height_m"]
    found["torso_m"] = stature - legs - found["neck_to_headtop_m"]
    return found


def _look(sex: Literal["m", "f"], rng: np.random.Generator) -> Look:
    shirt = _dye(rng)
    sleeves: tuple[Sleeve, ...] = ("short", "short", "long", "none" if sex == "f" else "long")
    cuts: tuple[Hair, ...] = ("bob", "tail", "short") if sex == "f" else ("short", "short", "bald")
    return Look(
        sleeve=one_of(rng, sleeves),
        shorts=bool(rng.random() < 0.25),
        hair=one_of(rng, cuts),
        pattern=one_of(rng, PATTERNS),
        pitch_m=float(rng.uniform(0.02, 0.05)),
        loose_top_m=float(rng.uniform(0.008, 0.024)),
        loose_legs_m=float(rng.uniform(0.006, 0.026)),
        hem_m=float(rng.uniform(-0.03, 0.1)),
        skin=one_of(rng, _SKINS),
        hair_colour=one_of(rng, _HAIRS),
        shirt=shirt,
        shirt_second=_dye(rng),
        trousers=_dye(rng, dark=0.6),
        shoes=_dye(rng, dark=0.45),
    )


def one_of(rng: np.random.Generator, choices: tuple[Choice, ...]) -> Choice:
    """A random element, uniformly."""
    return choices[int(rng.integers(len(choices)))]


def _dye(rng: np.random.Generator, dark: float = 1.0) -> Colour:
    hue, saturation, value = rng.random(), rng.uniform(0.05, 0.75), rng.uniform(0.25, 0.95) * dark
    channels = [
        value * (1.0 - saturation * (0.5 - 0.5 * math.cos(2 * math.pi * (hue + k / 3))))
        for k in range(3)
    ]
    blue, green, red = (int(255 * channel) for channel in channels)
    return (blue, green, red)
