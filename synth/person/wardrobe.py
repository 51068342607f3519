"""Clothes of all cuts and colours, for networks that look at pictures."""

from typing import Final

import numpy as np

from synth.person.people import PATTERNS, Colour, Hair, Look, Person, Sleeve, one_of

LONG_SHARE: Final = 0.16
"""Share of the people with clothes that hang over the thighs, a skirt or a coat."""
LONG_M: Final = (0.12, 0.55)
"""Range of their length below the hip joints."""
ALIKE_SHARE: Final = 0.18
"""Share of the people with top and trousers of one colour."""
GREY_SHARE: Final = 0.35
"""Share of nearly grey colours."""
LOOSE_M: Final = (0.002, 0.035)
SLEEVES: Final[tuple[Sleeve, ...]] = ("none", "short", "short", "long", "long")
HAIRS: Final[tuple[Hair, ...]] = ("bald", "short", "short", "bob", "tail")
SKINS: Final = ((190, 205, 240), (36, 52, 82))
HAIR: Final = ((90, 150, 190), (12, 14, 18))
"""The lightest and the darkest hair, blue, green, red."""
DYED_SHARE, BARE_SHARE = 0.1, 0.12
"""Shares of the people with hair of any colour, and without shoes."""


def dressed(someone: Person, rng: np.random.Generator) -> Person:
    """The same person in other clothes, of any colour.

    Args:
        someone: The person.
        rng: Source of all choices.
    """
    shirt = _dye(rng)
    skin = _between(*SKINS, rng)
    look = Look(
        sleeve=one_of(rng, SLEEVES),
        shorts=bool(rng.random() < 0.3),
        hair=one_of(rng, HAIRS),
        pattern=one_of(rng, PATTERNS),
        pitch_m=float(rng.uniform(0.015, 0.09)),
        loose_top_m=float(rng.uniform(*LOOSE_M)),
        loose_legs_m=float(rng.uniform(*LOOSE_M)),
        hem_m=float(rng.uniform(*(LONG_M if rng.random() < LONG_SHARE else (-0.04, 0.1)))),
        skin=skin,
        hair_colour=_dye(rng) if rng.random() < DYED_SHARE else _between(*HAIR, rng),
        shirt=shirt,
        shirt_second=_dye(rng),
        trousers=shirt if rng.random() < ALIKE_SHARE else _dye(rng),
        shoes=skin if rng.random() < BARE_SHARE else _dye(rng),
    )
    return someone._replace(look=look)


def _dye(rng: np.random.Generator) -> Colour:
    value = 255.0 * rng.uniform(0.04, 1.0)
    strength = 0.12 if rng.random() < GREY_SHARE else rng.uniform(0.1, 0.9)
    tint = 1.0 - strength * rng.random(3)
    return _colour(value * tint / tint.max())


def _between(light: Colour, dark: Colour, rng: np.random.Generator) -> Colour:
    mixed = np.array(light) + rng.random() * (np.array(dark) - np.array(light))
    return _colour(mixed * rng.uniform(0.92, 1.08, 3))


def _colour(channels: np.ndarray) -> Colour:
    blue, green, red = (int(value) for value in np.clip(channels, 0, 255))
    return (blue, green, red)
