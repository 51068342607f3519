"""Made-up streams: every posture once, and the truth of when."""

import numpy as np
import pytest

from synth.motion.motions import MOTION, POSTURES
from synth.motion.streaming import LEFT_DEG, streamed
from synth.person.people import person
from synth.person.skeleton import ANGLES


@pytest.mark.parametrize("seed", [3, 8])
def test_every_posture_is_shown_once_and_pauses_lie_between(seed: int) -> None:
    motion = streamed(person(seed), 1)
    assert sorted(act.name for act in motion.acts) == sorted(POSTURES)
    for before, after in zip(motion.acts, motion.acts[1:], strict=False):
        assert after.first - before.last >= 0.7 * motion.fps
    assert motion.acts[0].first > np.flatnonzero(motion.phase == MOTION)[0]
    assert motion.acts[-1].last < len(motion.phase)


def test_the_body_leaves_its_stance_where_the_truth_says() -> None:
    """At the ends of a squat the knees are bent by about the bound, before and after by less."""
    motion = streamed(person(4), 2, postures=("squat",))
    act, knee = motion.acts[0], motion.angles_deg[:, ANGLES.index("l_knee")]
    stance_deg = knee[act.first - 5]
    assert knee[act.first : act.last].max() - stance_deg > 60
    assert abs(knee[act.last + 3] - stance_deg) < LEFT_DEG + 3


def test_the_same_seed_gives_the_same_stream_and_nobody_leaves_the_room() -> None:
    one, again = streamed(person(5), 1), streamed(person(5), 1)
    assert np.array_equal(one.angles_deg, again.angles_deg, equal_nan=True)
    assert np.nanmax(np.abs(one.root_m[:, [0, 2]])) < 2.0
