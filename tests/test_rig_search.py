"""When a live run asks for a rig, and whether it takes one: somebody who moves is made up."""

import msgspec
import numpy as np
import pytest
from staging import report, silhouettes, standing

from common.bus.messages import Landmarks, Report, ViewerNumber
from common.rig.camera import paper_rig
from integrator.live_rig import rig_search
from integrator.live_rig.rig_job import Job, Solved, Trusted, track_of_bytes
from integrator.live_rig.rig_search import ASKS_S, State, answered, refusal_of
from integrator.pairing import Pair

HZ = 15
RIG = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0))
MASKS = silhouettes(standing())
GOOD = Solved(rig=RIG, gap_mm=15.0, turn_error_deg=6.0, trust=Trusted(11.0, ()))


def seen(
    viewer: ViewerNumber, n: int, swing: float, sure: float = 0.9, late_s: float = 0.0
) -> Report:
    """Landmarks of somebody upright whose arms swing by so many pixels."""
    joints_px = np.random.default_rng(1).uniform(30, 90, (15, 2))
    joints_px[:2] = (60.0, 75.0), (62.0, 40.0)
    joints_px[3:9, 1] += swing * np.sin(n)
    places = tuple((x, y) for x, y in joints_px.tolist())
    moment = {"frame": n, "captured_s": n / HZ + late_s, "clock_s": n / HZ}
    return report(viewer, MASKS[viewer - 1], landmarks=Landmarks(places, (sure,) * 15), **moment)


def both(n: int, swing: float = 30.0, sure: float = 0.9) -> Pair:
    return Pair(seen(1, n, swing, sure), seen(2, n, swing, sure))


def moved(seconds: float, state: State | None = None, first: int = 0) -> tuple[State, list[Job]]:
    state = state or rig_search.init(1 / HZ, 1.75)
    jobs = []
    for n in range(first, first + round(seconds * HZ) + 1):
        state, job = rig_search.step(state, both(n))
        jobs += [] if job is None else [job]
    return state, jobs


def test_a_rig_is_asked_for_after_the_first_seconds_of_motion_and_once_until_it_is_answered() -> (
    None
):
    state, jobs = moved(ASKS_S[1] + 1)
    assert len(jobs) == 1
    assert state.waits
    track = track_of_bytes(jobs[0].tracks[1])
    assert track.times_s[-1] - track.times_s[0] == pytest.approx(ASKS_S[0], abs=2 / HZ)
    assert track.joints_px.shape == (len(track.times_s), 15, 2)


def test_no_more_is_asked_than_the_table_says_and_nothing_is_kept_then() -> None:
    state, first, asked = rig_search.init(1 / HZ, 1.75), 0, 0
    for _ in range(90):
        state, jobs = moved(1.0, state, first)
        first, asked = first + HZ + 1, asked + len(jobs)
        if jobs:
            state, _ = answered(state, Solved(refusal="nothing"))
    assert asked == len(ASKS_S)
    assert state.is_over
    assert state.rows == ((), ())


@pytest.mark.parametrize("pair", [lambda n: both(n, 0.0), lambda n: both(n, 30.0, 0.2)])
def test_who_stands_still_or_is_hardly_seen_tells_nothing_and_fills_no_memory(pair: object) -> None:
    state = rig_search.init(1 / HZ, 1.75)
    for n in range(600):
        state, job = rig_search.step(state, pair(n))  # type: ignore[operator]
        assert job is None
    assert len(state.rows[0]) < 3 * HZ


def test_what_is_left_out_leaves_a_row_of_nobody_in_both_views() -> None:
    state, _ = moved(1.0)
    state, _ = rig_search.step(state, Pair(seen(1, 30, 30.0), None))
    state, _ = rig_search.step(state, Pair(seen(1, 31, 30.0), None))
    for rows in state.rows:
        track = track_of_bytes(b"".join(rows))
        assert (track.confidence[-1] == 0.0).all()
        assert track.confidence[-2].min() > 0.0


def test_a_believable_rig_is_taken_and_a_like_one_after_it_is_not() -> None:
    state, _ = moved(ASKS_S[0])
    state, is_taken = answered(state, GOOD)
    assert is_taken
    assert state.rig == RIG
    state, jobs = moved(ASKS_S[1], state, 100)
    assert jobs[0].rig == RIG
    state, is_taken = answered(state, msgspec.structs.replace(GOOD, before=Trusted(12.0, ())))
    assert not is_taken


@pytest.mark.parametrize(
    ("before", "asked", "is_taken"),
    [
        (Trusted(30.0, ()), 2, True),
        (Trusted(13.0, ()), 2, False),
        (Trusted(13.0, ()), 3, True),
        (Trusted(10.0, ()), 3, False),
        (Trusted(13.0, ("floor",)), 2, True),
    ],
    ids=["far closer", "a little closer", "of much more motion", "farther apart", "old one fails"],
)
def test_a_rig_is_changed_only_for_a_clearly_better_one(
    before: Trusted, asked: int, is_taken: bool
) -> None:
    state = rig_search.init(1 / HZ, 1.75)._replace(asked=asked, taken=1, waits=True, rig=RIG)
    assert answered(state, msgspec.structs.replace(GOOD, before=before))[1] == is_taken


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"refusal": "nobody"}, "nobody"),
        ({"trust": None}, "too little"),
        ({"trust": Trusted(80.0, ("apart",))}, "80 mm apart"),
        ({"gap_mm": 50.0}, "gaps"),
        ({"turn_error_deg": 20.0}, "20 degrees"),
        ({"trust": Trusted(11.0, ("late",)), "late_s": 0.2}, ""),
    ],
)
def test_a_rig_that_is_not_believable_is_refused_with_the_reason(
    changed: dict[str, object], why: str
) -> None:
    told = refusal_of(msgspec.structs.replace(GOOD, **changed))
    assert why in told if why else told == ""


def test_view_2_is_set_back_by_what_it_is_late_and_rows_keep_its_own_time() -> None:
    state, _ = moved(ASKS_S[0])
    state, _ = answered(state, msgspec.structs.replace(GOOD, late_s=0.2))
    assert state.late_s == 0.2
    state, _ = rig_search.step(state, Pair(seen(1, 65, 30.0), seen(2, 65, 30.0, late_s=-0.2)))
    assert state.last_s == pytest.approx((65 / HZ, 65 / HZ))
    state, _ = moved(0.0, rig_search.init(1 / HZ, 1.75))
    state, _ = answered(state._replace(asked=1), msgspec.structs.replace(GOOD, late_s=0.02))
    assert state.late_s == 0.0


def test_what_was_asked_before_a_camera_was_moved_is_not_taken() -> None:
    state, _ = moved(ASKS_S[0])
    state = rig_search.anew(state, RIG, (2,))
    assert state.rows == ((), ())
    state, is_taken = answered(state, GOOD)
    assert not is_taken
    state, jobs = moved(ASKS_S[0], state, 100)
    assert (jobs[0].rig, jobs[0].moved) == (RIG, (2,))


def test_a_moved_camera_is_placed_by_the_person_even_where_views_agree_as_well_before() -> None:
    state = rig_search.init(1 / HZ, 1.75)._replace(asked=1, waits=True, rig=RIG, moved=(2,))
    assert answered(state, msgspec.structs.replace(GOOD, before=Trusted(11.0, ())))[1]
    refused = msgspec.structs.replace(GOOD, trust=Trusted(80.0, ("apart",)))
    assert not answered(state, refused)[1]
