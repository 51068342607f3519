"""The dance that stands in for the thesis's second video (T24, T27)."""

from itertools import pairwise

import numpy as np
import pytest
from dancing import FRAMES, dance, faced
from dancing_effort import mending_inputs

from animator.take import Take, depth_of, take_of
from common.body.body import JOINT_NAMES, LIMBS
from common.notes.notes import Notes
from synth.motion.motions import Motion
from synth.person.people import person
from synth.person.skeleton import JOINTS
from tritrack.single.ledger import PRINTED, Count, ledger

DANCING = PRINTED[1]


@pytest.fixture(scope="module")
def danced() -> Motion:
    return dance(person(900), 0)


def true_take(motion: Motion) -> Take:
    """A run without an error, that was sure of all."""
    n = len(motion.phase)
    joints_m = motion.joints_m[:, [JOINTS.index(name) for name in JOINT_NAMES]]
    return take_of(
        {
            "frame": np.arange(n),
            "joints_px": np.zeros((n, 2, 15, 2)),
            "joints_m": joints_m,
            "confidence": np.ones((n, 15)),
            "orientation": faced(motion),
        }
    )


def test_the_dance_is_as_long_as_the_thesis_video(danced: Motion) -> None:
    assert len(danced.phase) == FRAMES == DANCING.frames
    assert danced.present.all()


def test_the_orientation_changes_seven_times(danced: Motion) -> None:
    """ "The orientation of the body changes 7 times along the 200 frames" (4.3)."""
    words = faced(danced)
    changes = np.flatnonzero(words[1:] != words[:-1])
    rests = [words[at] for at in np.linspace(12, 187, 8).astype(int)]
    assert sum(a != b for a, b in pairwise(rests)) == 7
    assert len(changes) <= 7 + 4, "a turn may pass one word on its way"
    assert set(rests) == {
        *("forward_left", "left", "backward_left"),
        *("backward_right", "right", "forward_right"),
    }


def test_the_dancers_limbs_lean_both_ways(danced: Motion) -> None:
    """What makes the 44 inputs for directions: limbs that swing through the picture's plane."""
    leans = depth_of(true_take(danced).joints_m)
    both = ((leans > 0).any(axis=0) & (leans < 0).any(axis=0)).sum()
    assert both >= 8


def test_the_dance_takes_about_what_the_thesis_dance_took(danced: Motion) -> None:
    """506 by hand there, 33 key frames, 44 directions, 7 orientations; we count the first too.

    Ours is 0 where nothing is in doubt.
    """
    made = ledger(true_take(danced), Notes())
    assert made.key_frames == pytest.approx(DANCING.key_frames, abs=4)
    assert made.by_hand == pytest.approx(DANCING.by_hand, rel=0.1)
    assert made.thesis.orientation == DANCING.inputs.orientation + 1
    assert 20 <= made.thesis.depth <= 60
    assert (made.given.total, made.open.total) == (0, 0)


def test_what_is_wrong_is_mended_by_as_many_inputs_as_it_has_runs(danced: Motion) -> None:
    """A run that took one orientation for all frames lacks the seven changes; a wrist that was
    twice lost is placed twice; a forearm that leans as it should needs nothing."""
    truth = true_take(danced)
    wrist, forearm = JOINT_NAMES.index("l_wrist"), LIMBS.index("l_lower_arm")
    assert mending_inputs(truth, truth, 5.0) == Count()
    stubborn = truth._replace(orientation=np.full(FRAMES, truth.orientation[0]))
    lost = truth.joints_px.copy()
    lost[[20, 21, 60], wrist] += 9.0
    lost[100, wrist] += 3.0
    found = mending_inputs(stubborn._replace(joints_px=lost), truth, 5.0)
    assert found == Count(orientation=6, joints=2)
    flat = truth._replace(joints_m=truth.joints_m * (1.0, 1.0, 0.0))
    changes = depth_of(truth.joints_m)[:, forearm]
    runs = int(np.count_nonzero(np.diff(changes[changes != 0]))) + 1
    alone = flat.joints_m.copy()
    others = [i for i, name in enumerate(JOINT_NAMES) if name != "l_wrist"]
    alone[:, others] = truth.joints_m[:, others]
    alone[:, wrist, 2] = truth.joints_m[:, JOINT_NAMES.index("l_elbow"), 2]
    assert mending_inputs(flat._replace(joints_m=alone), truth, 5.0) == Count(depth=runs)
