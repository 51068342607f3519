"""What both views saw in the last seconds, held against rows that are counted by hand."""

import numpy as np
import pytest
from staging import RIG, report, silhouettes, standing

from common.body.observation import Landmarks
from common.bus.instant import TwoViews
from common.bus.messages import View, ViewerNumber
from integrator.live_rig.recent_views import State, stand_before, step
from integrator.live_rig.rig_job import track_of_bytes

MASKS = silhouettes(standing())


def seen(viewer: ViewerNumber, captured_s: float, sure: float = 0.9) -> View:
    """Somebody upright, two pixels further right in view 2."""
    places = tuple((60.0 + n + 2.0 * viewer, 110.0 - 5.0 * n) for n in range(15))
    upright = (places[1], places[0], *places[2:])
    upright = tuple((x, 30.0 + y / 2) for x, y in sorted(upright, key=lambda at: -at[1]))
    shown = Landmarks(upright, (sure,) * 15, 10.0 * viewer, 0.9)
    return report(viewer, MASKS[viewer - 1], landmarks=shown, captured_s=captured_s)


def after(times_s: list[float]) -> State:
    state = State()
    for at_s in times_s:
        state = step(state, (seen(1, at_s), seen(2, at_s + 0.01)))
    return state


def test_eight_seconds_are_kept() -> None:
    state = after([0.0, 0.5, 7.9, 8.0])
    assert [row[0] for row in state.rows] == [0.5, 7.9, 8.0]
    assert [row[0] for row in after([0.0, 0.5, 7.9]).rows] == [0.0, 0.5, 7.9]


def test_a_stand_is_what_each_view_saw_a_second_before_a_move_was_told() -> None:
    state = after([1.0, 2.0, 2.9, 3.0, 3.5])
    stand = stand_before(state, RIG, 4.0)
    assert stand.rig == RIG
    first, second = (track_of_bytes(told) for told in stand.tracks)
    assert first.times_s.tolist() == [1.0, 2.0, 2.9]
    assert second.times_s == pytest.approx([1.01, 2.01, 2.91])
    assert first.facing_deg.tolist() == [10.0] * 3
    assert second.facing_deg.tolist() == [20.0] * 3
    assert (second.joints_px - first.joints_px)[..., 0] == pytest.approx(np.full((3, 15), 2.0))


@pytest.mark.parametrize(
    ("pair", "counts"),
    [
        ((seen(1, 1.0), None), False),
        ((None, seen(2, 1.0)), False),
        ((seen(1, 1.0), report(2, MASKS[1])), False),
        ((report(1, MASKS[0]), seen(2, 1.0)), False),
        ((seen(1, 1.0, 0.39), seen(2, 1.0)), False),
        ((seen(1, 1.0), seen(2, 1.0, 0.39)), False),
        ((seen(1, 1.0, 0.41), seen(2, 1.0, 0.41)), True),
    ],
)
def test_only_instants_at_which_both_views_are_sure_of_somebody_count(
    pair: TwoViews, counts: bool
) -> None:
    assert bool(step(State(), pair).rows) is counts
