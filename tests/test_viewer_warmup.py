"""What is stepped through before the first frame: a person, guided as a run guides one."""

from itertools import pairwise
from typing import Any

import msgspec
import numpy as np
import pytest

from common.body.body import POSE_INDEX
from common.body.proportions import thesis_bdp
from common.bus.messages import MOST_VIEWS
from common.config.settings import Settings
from common.method import DEFAULT
from viewer import track
from viewer.background.background import learn
from viewer.captured_frame import CapturedFrame
from viewer.viewer_warmup import warm_up


def test_a_person_in_the_opening_posture_is_stepped_through_with_every_kind_of_guide(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Seven tenths of the picture tall, arms out, unlike the background; no picture comes twice."""
    wide, high = 80, 60
    settings = msgspec.structs.replace(Settings(), landmarks="none")
    begun = track.init(
        track.Setup(1, None, settings, DEFAULT), learn([np.full((high, wide, 3), 90, np.uint8)])
    )
    shown: list[tuple[Any, CapturedFrame, Any]] = []

    def step(state: Any, frame: CapturedFrame, guide: Any) -> Any:
        shown.append((state, frame, guide))
        return len(shown), None

    monkeypatch.setattr(track, "step", step)
    warm_up(begun, (wide, high))
    assert [state for state, _, _ in shown] == [begun, 1, 2, 3]
    assert [frame.index for _, frame, _ in shown] == [0, 1, 2, 3]
    assert shown[0][2] is None
    asked = [(guide.measured, guide.stick) for _, _, guide in shown[1:]]
    assert asked == [(False, False), (True, False), (True, True)]
    guide = shown[1][2]
    assert guide.status == "tracking"
    assert guide.scale_px_per_m == (42.0,) * MOST_VIEWS
    assert guide.root_px == ((40.0, 33.0),) * MOST_VIEWS
    assert guide.bdp == thesis_bdp(1.0)
    arms = [guide.pose[POSE_INDEX[f"{side}_shoulder_z"]] for side in "rl"]
    assert arms == [90.0, 270.0]
    for (_, one, _), (_, other, _) in pairwise(shown):
        assert not np.array_equal(one.picture, other.picture)
    person = shown[0][1].picture[..., 0] == 255 - 90
    assert (shown[0][1].picture[~person] == 90).all()
    rows, columns = np.flatnonzero(person.any(axis=1)), np.flatnonzero(person.any(axis=0))
    assert rows[-1] - rows[0] + 1 == pytest.approx(42, abs=2)
    assert columns[0] + columns[-1] + 1 == wide
    assert columns[-1] - columns[0] > 30
