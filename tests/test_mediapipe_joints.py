"""What is made of MediaPipe's points, and what its child may answer, by hand."""

import numpy as np
import pytest

from common.platform.platform import Broken
from viewer.landmarks.fifteen_joints import facing_deg, fifteen, fifteen_shares
from viewer.landmarks.keypoint_layouts import body_points
from viewer.landmarks.mediapipe_joints import landmarks_of
from viewer.landmarks.mediapipe_protocol import (
    BYTES,
    NOBODY,
    POINTS,
    READY,
    REFUSED,
    answer_of,
    encoded,
)


def points() -> np.ndarray:
    rng = np.random.default_rng(4)
    return np.column_stack([rng.uniform(0, 64, 33), rng.uniform(0, 48, 33), rng.random(33)]).astype(
        np.float32
    )


def test_points_of_the_shown_picture_are_told_in_the_working_one() -> None:
    """Half as wide and a third as high; the facing is that of the picture as it was shown."""
    given = points()
    found = landmarks_of(given, (64, 48), (32, 16))
    body = body_points(given)
    scale = np.array([1 / 2, 1 / 3])
    assert np.array(found.joints_px) == pytest.approx(scale * fifteen(body[:, :2]))
    assert np.array(found.confidence) == pytest.approx(fifteen_shares(body[:, 2]))
    assert found.facing_deg == pytest.approx(facing_deg(body[:, :2]))
    assert found.facing_confidence == 0.9
    ends = np.array(found.extremities_px)
    assert ends[0] == pytest.approx(scale * given[0, :2])
    assert ends[1] == pytest.approx(scale * given[29, :2])
    assert ends[3] == pytest.approx(scale * given[[17, 19], :2].mean(axis=0))
    assert found.extremities_confidence[3] == pytest.approx(float(given[[17, 19], 2].min()))


def test_answers_come_back_as_they_were_sent() -> None:
    given = points()
    sent = encoded(POINTS, 12, given)
    assert len(sent) == len(encoded(READY)) == BYTES
    answer = answer_of(sent)
    assert (answer.kind, answer.frame, answer.text) == (POINTS, 12, "")
    assert np.array_equal(answer.points, given)
    assert answer_of(encoded(READY)).frame == -1
    assert answer_of(encoded(NOBODY, 3)).frame == 3
    refused = answer_of(encoded(REFUSED, text="no module named attrs"))
    assert refused.text == "no module named attrs"
    assert len(answer_of(encoded(REFUSED, text="x" * 1000)).text) == 4 * 33 * 3


def test_what_no_child_of_ours_sends_is_refused() -> None:
    """Another beginning, another kind, and points that are nowhere; of nobody any are."""
    nowhere = points()
    nowhere[7, 1] = np.nan
    with pytest.raises(Broken, match="points that are nowhere"):
        answer_of(encoded(POINTS, 1, nowhere))
    assert answer_of(encoded(NOBODY, 1, nowhere)).kind == NOBODY
    for wrong in (b"tml2" + encoded(READY)[4:], encoded(b"q")):
        with pytest.raises(Broken, match="it sent what is no answer"):
            answer_of(wrong)
