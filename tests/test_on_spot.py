"""A person who is there from the first frame and stays on one spot."""

import numpy as np
import pytest

from synth.motion.motions import MOTION, stance
from synth.motion.on_spot import ON_SPOT, PIECE_S, bending, on_spot, turning
from synth.person.people import person
from synth.person.skeleton import JOINTS

FEET = [JOINTS.index(f"{side}_ankle") for side in "lr"]


@pytest.mark.parametrize("seed", range(40, 48))
def test_the_person_is_there_from_the_first_frame_and_leaves_neither_spot_nor_floor(
    seed: int,
) -> None:
    """The middle of the feet stays within 20 cm; no ankle rises by more than heels do."""
    motion = on_spot(person(seed), 1)
    assert len(motion.phase) == 90
    assert (motion.phase == MOTION).all()
    assert np.isfinite(motion.joints_m).all()
    feet = motion.joints_m[:, FEET]
    middle = feet.mean(axis=1)[:, [0, 2]]
    assert np.linalg.norm(middle - np.median(middle, axis=0), axis=1).max() < 0.2
    assert feet[..., 1].max() < 0.2


def test_what_the_person_does_differs_by_seed_and_only_by_seed() -> None:
    first, again, other = (on_spot(person(5), seed).joints_m for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.3


def test_whole_bodies_turn_both_ways_and_trunks_bend_far() -> None:
    """Over many takes: shoulders against camera 1, and the neck's height over the pelvis's."""
    neck, shoulders = JOINTS.index("neck"), [JOINTS.index(f"{side}_shoulder") for side in "lr"]
    turned_deg, bent = [], []
    for seed in range(30):
        joints = on_spot(person(seed), 7).joints_m
        left, right = joints[:, shoulders[0]], joints[:, shoulders[1]]
        way = left - right
        turned_deg += np.degrees(np.arctan2(-way[:, 2], way[:, 0])).tolist()
        up = joints[:, neck] - joints[:, 0]
        bent += np.degrees(np.arctan2(np.hypot(up[:, 0], up[:, 2]), up[:, 1])).tolist()
    assert min(turned_deg) < -60
    assert max(turned_deg) > 60
    assert max(bent) > 45


@pytest.mark.parametrize("move", [bending(50.0), turning(60.0)])
def test_who_bends_or_turns_is_back_at_the_end_of_the_shortest_behaviour(move: object) -> None:
    style = person(3).style
    t = np.linspace(0.0, PIECE_S[0], 33)
    still = stance(style, t)
    for name, values in move(t, style, still).items():  # type: ignore[operator]
        assert values[0] == pytest.approx(still[name][0])
        assert values[-1] == pytest.approx(still[name][-1])
        assert np.abs(values - still[name]).max() > 15


def test_no_behaviour_lifts_a_foot() -> None:
    assert not [name for name in ON_SPOT if name.startswith(("walk", "kick"))]
    assert {"bend", "turn", "shift", "raise_both_lateral", "squat"} <= set(ON_SPOT)
