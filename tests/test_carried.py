"""The thing that goes from hand to hand."""

import numpy as np

from synth.motion.motions import EMPTY, MOTION, performance
from synth.person.people import person
from synth.picture.actors import Part
from synth.scene.carried import HAND, SIDES_M, carried
from synth.scene.plot import Contact

FPS = 15.0


def people(count: int) -> list[Part]:
    return [Part(person(n), performance(person(n), "walk_in_place", 1)) for n in range(count)]


def test_it_is_in_the_givers_hand_then_in_the_takers() -> None:
    """From 3 to 4 s; the second contact is of two others, the third takes it on at 4.5 s."""
    parts = people(3)
    contacts = (
        Contact("hand over", (1, 0), 3.0, 4.0),
        Contact("hand over", (1, 2), 4.0, 4.2),
        Contact("hug", (0, 1), 4.2, 4.4),
        Contact("hand over", (2, 0), 4.4, 4.6),
    )
    (thing,) = carried(parts, contacts, FPS)
    below = [0.0, SIDES_M[1] / 2, 0.0]
    hands = [part.motion.joints_m[:, HAND] - below for part in parts]
    phase = parts[1].motion.phase
    assert np.isnan(thing.places_m[phase < MOTION]).all()
    np.testing.assert_array_equal(thing.places_m[29:49], hands[1][29:49])
    np.testing.assert_array_equal(thing.places_m[56:64], hands[0][56:64])
    np.testing.assert_array_equal(thing.places_m[70:], hands[2][70:])
    between = np.linalg.norm(thing.places_m[52] - hands[1][52])
    assert 0.2 < between / np.linalg.norm(hands[0][52] - hands[1][52]) < 0.8


def test_it_goes_out_with_whoever_holds_it_and_there_is_none_without_a_hand_over() -> None:
    parts = people(2)
    gone = parts[1].motion.joints_m.copy()
    gone[60:] = np.nan
    motion = parts[1].motion._replace(joints_m=gone)
    parts[1] = Part(parts[1].someone, motion)
    (thing,) = carried(parts, (Contact("hand over", (0, 1), 3.0, 3.4),), FPS)
    assert np.isfinite(thing.places_m[55]).all()
    assert np.isnan(thing.places_m[60:]).all()
    assert (parts[0].motion.phase[:9] == EMPTY).all()
    assert carried(parts, (Contact("hug", (0, 1), 3.0, 3.4),), FPS) == ()
