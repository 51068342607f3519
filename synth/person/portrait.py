"""Head, hair, hands and shoes: the differences between front and back."""

from collections.abc import Iterable
from typing import Final

from common.body.body import Vector
from synth.person.people import Person
from synth.person.rings import Ring
from synth.person.skeleton import HEEL_SHARE, shoe_length

FACE: Final = (
    (-0.12, 1.1, 0.75, 0.02, "skin"),
    (0.1, 0.62, 0.6, 0.05, "skin"),
    (0.24, 0.62, 0.62, 0.09, "skin"),
    (0.27, 0.66, 0.62, 0.22, "skin"),
    (0.36, 0.84, 0.84, 0.17, "skin"),
    (0.43, 0.9, 0.9, 0.15, "lips"),
    (0.455, 0.9, 0.91, 0.15, "skin"),
    (0.58, 0.97, 0.97, 0.14, "dark"),
    (0.63, 0.98, 0.98, 0.14, "skin"),
    (0.75, 1.0, 1.0, 0.12, "skin"),
    (0.87, 0.88, 0.9, 0.11, "skin"),
    (0.955, 0.6, 0.62, 0.1, "skin"),
    (0.985, 0.2, 0.2, 0.1, "skin"),
)
"""Sections from the neck up: height and forward place in units of neck to crown, half width and
half depth in units of the head's, material. The eyes lie in the shade of the brow."""

NOSE: Final = (
    (0.44, 0.08, 0.04, 0.63, "skin"),
    (0.47, 0.17, 0.18, 0.61, "skin"),
    (0.62, 0.1, 0.08, 0.56, "skin"),
)

HAIR: Final = {
    "bald": (),
    "short": (0.52, 1.04),
    "bob": (0.18, 1.2),
    "tail": (0.42, 1.05),
}
"""Height of the hair's lower edge behind, and its distance from the head."""

TAIL: Final = (
    (-0.3, 0.12, 0.08, -0.42, "hair"),
    (0.0, 0.33, 0.22, -0.44, "hair"),
    (0.4, 0.4, 0.27, -0.5, "hair"),
    (0.78, 0.3, 0.2, -0.4, "hair"),
)

DEPTH_SHARE: Final = 0.92
"""Skull's depth over the measured one, which includes nose and hair."""

Section = tuple[float, float, float, float, str]


def head(p: Person, at: dict[str, Vector]) -> list[list[Ring]]:
    """Neck and face, nose, ears, hair."""
    tubes = [_upright(p, at, FACE), _upright(p, at, NOSE)]
    tubes += [_ear(p, at, sign) for sign in (-1.0, 1.0)]
    if p.look.hair == "bald":
        return tubes
    tubes.append(_upright(p, at, _cap(*HAIR[p.look.hair])))
    if p.look.hair == "tail":
        tubes.append(_upright(p, at, TAIL))
    return tubes


def _upright(p: Person, at: dict[str, Vector], sections: Iterable[Section]) -> list[Ring]:
    """Rings along the head; those of the neck follow the chest in part."""
    m = p.measures
    tall, x = m["neck_to_headtop_m"], m["head_halfwidth_m"]
    z, neck = DEPTH_SHARE * m["head_halfdepth_m"], float(at["head"][1])
    return [
        Ring(
            (0.0, neck + up * tall, forward * tall),
            wide * x,
            deep * z,
            ("chest", "head"),
            min(1.0, max(0.0, (up + 0.12) / 0.36)) if material == "skin" else 1.0,
            material,
            2.2,
        )
        for up, wide, deep, forward, material in sections
    ]


def _cap(low: float, puff: float) -> tuple[Section, ...]:
    """Hair from its lower edge behind to the crown."""
    return (
        (low, 0.7, 0.4, -0.12, "hair"),
        (low + 0.05, 0.98 * puff, 0.62 * puff, -0.09, "hair"),
        (0.68, 1.04 * puff, 0.8, -0.02, "hair"),
        (0.78, 1.05, 0.99, 0.06, "hair"),
        (0.89, 0.97, 1.0, 0.09, "hair"),
        (0.97, 0.68, 0.72, 0.09, "hair"),
        (1.0, 0.25, 0.25, 0.09, "hair"),
    )


def _ear(p: Person, at: dict[str, Vector], sign: float) -> list[Ring]:
    tall, x = p.measures["neck_to_headtop_m"], sign * 1.02 * p.measures["head_halfwidth_m"]
    neck = float(at["head"][1])
    return [
        Ring((x, neck + up * tall, 0.1 * tall), 0.008, z, ("chest", "head"), 1.0, "skin")
        for up, z in ((0.44, 0.006), (0.5, 0.014), (0.6, 0.017), (0.64, 0.008))
    ]


def hand(p: Person, at: dict[str, Vector], side: str) -> list[Ring]:
    """A mitten, its palm towards the body."""
    m = p.measures
    x, wrist, _ = (float(value) for value in at[f"{side}_hand"])
    long, thin = m["hand_m"], m["forearm_radius_m"]
    bones = (f"{side}_forearm", f"{side}_hand")
    sections = (
        (-0.04, 0.72, 0.8),
        (0.12, 0.6, 0.95),
        (0.32, 0.52, 1.32),
        (0.52, 0.48, 1.36),
        (0.72, 0.4, 1.2),
        (0.9, 0.33, 0.95),
        (1.0, 0.15, 0.45),
    )
    return [
        Ring((x, wrist - d * long, 0.0), wide * thin, deep * thin, bones, 1.0, "skin", 2.4)
        for d, wide, deep in sections
    ]


def thumb(p: Person, at: dict[str, Vector], side: str) -> list[Ring]:
    """Thumb on the front edge of a hanging hand."""
    m = p.measures
    x, wrist, _ = (float(value) for value in at[f"{side}_hand"])
    long, thin = m["hand_m"], m["forearm_radius_m"]
    bones = (f"{side}_forearm", f"{side}_hand")
    return [
        Ring((x, wrist - d * long, z * thin), r * thin, r * thin, bones, 1.0, "skin")
        for d, z, r in ((0.1, 0.5, 0.3), (0.22, 1.2, 0.42), (0.42, 1.85, 0.36), (0.55, 1.95, 0.12))
    ]


def shoe(p: Person, at: dict[str, Vector], side: str) -> list[Ring]:
    """Rings along z, from heel to toe; `half_z` is the half height here."""
    m = p.measures
    x, ankle, _ = (float(value) for value in at[f"{side}_foot"])
    long, high = shoe_length(m), m["ankle_height_m"] / 2
    bones = (f"{side}_foot", f"{side}_foot")
    sections = (
        (0.0, 0.45, 0.7),
        (0.03, 0.7, 1.1),
        (0.2, 0.8, 1.3),
        (0.36, 0.82, 1.25),
        (0.55, 0.98, 0.9),
        (0.75, 1.05, 0.66),
        (0.92, 0.8, 0.5),
        (1.0, 0.3, 0.22),
    )
    return [
        Ring(
            (x, ankle - 2 * high + tall * high, (along - HEEL_SHARE) * long),
            wide * 0.17 * long,
            tall * high,
            bones,
            0.0,
            "shoes",
            3.0,
        )
        for along, wide, tall in sections
    ]
