"""When a live run asks for a rig, and whether it takes one: somebody who moves is made up."""

import msgspec
import numpy as np
import pytest
from staging import changed, person_of, report, silhouettes, standing

from common.body.observation import Landmarks
from common.bus.instant import TwoViews
from common.bus.messages import View, ViewerNumber
from common.rig.camera import paper_rig
from integrator.live_rig import rig_search
from integrator.live_rig.rig_job import Job, Solved, Stand, Trusted, Unsolved, track_of_bytes
from integrator.live_rig.rig_search import ASKS_S, State, answered, refusal_of

HZ = 15
RIG = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0))
MASKS = silhouettes(standing())
GOOD = Solved(rig=RIG, gap_mm=15.0, turn_error_deg=6.0, trust=Trusted(11.0, ()))


def seen(
    viewer: ViewerNumber, n: int, swing: float, sure: float = 0.9, late_s: float = 0.0
) -> View:
    """Landmarks of somebody upright whose arms swing by so many pixels."""
    joints_px = np.random.default_rng(1).uniform(30, 90, (15, 2))
    joints_px[:2] = (60.0, 75.0), (62.0, 40.0)
    joints_px[3:9, 1] += swing * np.sin(n)
    places = tuple((x, y) for x, y in joints_px.tolist())
    moment = {"frame": n, "captured_s": n / HZ + late_s, "clock_s": n / HZ}
    return report(viewer, MASKS[viewer - 1], landmarks=Landmarks(places, (sure,) * 15), **moment)


def both(n: int, swing: float = 30.0, sure: float = 0.9) -> TwoViews:
    return (seen(1, n, swing, sure), seen(2, n, swing, sure))


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
            state, _ = answered(state, Unsolved("nothing"))
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
    state, _ = rig_search.step(state, (seen(1, 30, 30.0), None))
    state, _ = rig_search.step(state, (seen(1, 31, 30.0), None))
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
    answer = answered(state, msgspec.structs.replace(GOOD, before=before))[1]
    assert (answer is not None) == is_taken


@pytest.mark.parametrize(
    ("changed", "why"),
    [
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
    state, _ = rig_search.step(state, (seen(1, 65, 30.0), seen(2, 65, 30.0, late_s=-0.2)))
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


@pytest.mark.parametrize(
    ("before_mm", "now_mm", "asked", "taken", "is_taken"),
    [
        (18.0, 12.5, 2, 1, True),
        (17.4, 12.5, 2, 1, False),
        (40.0, 27.9, 2, 1, True),
        (40.0, 28.1, 2, 1, False),
        (12.5, 12.5, 3, 1, True),
        (12.4, 12.5, 3, 1, False),
        (12.5, 12.5, 3, 2, False),
        (12.5, 12.5, 4, 2, True),
    ],
    ids=["gains", "5 mm", "share", "no share", "4 times", "not", "twice", "4 times later"],
)
def test_what_a_jump_must_gain(
    before_mm: float, now_mm: float, asked: int, taken: int, is_taken: bool
) -> None:
    """More than 5 mm and to less than 0.7 of it, or nothing where four times as much was seen."""
    state = rig_search.init(1 / HZ, 1.75)._replace(asked=asked, taken=taken, rig=RIG)
    solved = msgspec.structs.replace(GOOD, before=Trusted(before_mm, ()), trust=Trusted(now_mm, ()))
    found, answer = answered(state, solved)
    assert answer == (solved if is_taken else None)
    assert found.taken == (asked if is_taken else taken)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"gap_mm": 35.0, "turn_error_deg": 15.0}, ""),
        ({"gap_mm": 35.1}, "both views stay 11 mm apart (gaps)"),
        ({"turn_error_deg": 15.6}, "camera 2 is known to 16 degrees only"),
        (
            {"trust": Trusted(80.4, ("apart", "late", "floor"))},
            "both views stay 80 mm apart (apart, floor)",
        ),
    ],
)
def test_a_refusal_is_told_from_its_bound_on_with_its_number(
    changed: dict[str, object], told: str
) -> None:
    assert refusal_of(msgspec.structs.replace(GOOD, **changed)) == told
    assert refusal_of(Unsolved("fits no rig")) == "fits no rig"


def test_why_a_person_told_no_rig_is_said() -> None:
    state = rig_search.init(1 / HZ, 1.75)._replace(moved_s=2.4)
    why = rig_search.why_none
    assert why(state) == "both cameras saw somebody move for 2 s, of 4 needed"
    assert why(state._replace(refusal="gaps")) == "the person tells none (gaps)"
    late = "what the person tells was not found in time"
    assert why(state._replace(refusal="gaps", waits=True)) == late


@pytest.mark.parametrize(("late_s", "set_back_s"), [(0.04, 0.04), (0.0399, 0.0), (-0.05, -0.05)])
def test_view_2_is_set_back_from_six_tenths_of_a_frame_on(late_s: float, set_back_s: float) -> None:
    solved = msgspec.structs.replace(GOOD, late_s=late_s)
    assert rig_search.set_back_s(solved, 1 / 15) == set_back_s


def test_a_job_says_all_that_is_known_and_a_new_search_keeps_what_stays() -> None:
    state, _ = moved(ASKS_S[0] - 0.5)
    stood = Stand(RIG, (b"1", b"2"))
    state = state._replace(rig=RIG, moved=(2,), stood=stood, late_s=0.03)
    state, jobs = moved(1.0, state, round((ASKS_S[0] - 0.5) * HZ) + 1)
    job = jobs[0]
    assert (job.size_px, job.stature_m, job.period_s) == ((160, 120), 1.75, 1 / HZ)
    assert (job.rig, job.moved, job.late_s, job.stood) == (RIG, (2,), 0.03, stood)
    assert job.tracks != (b"", b"")
    again = rig_search.anew(state, None, (1,), None)
    assert (again.last_s, again.late_s, again.waits, again.is_stale) == (
        state.last_s,
        0.03,
        True,
        True,
    )
    assert (again.rig, again.moved, again.stood, again.asked) == (None, (1,), None, 0)
    assert again.rows == ((), ())
    assert not rig_search.anew(state._replace(waits=False), None).is_stale


def test_pictures_of_two_sizes_tell_nothing() -> None:
    state, _ = moved(0.0)
    other = msgspec.structs.replace(seen(2, 9, 30.0), width=161)
    after, _ = rig_search.step(state, (seen(1, 9, 30.0), other))
    assert (after.rows, after.moved_s) == (state.rows, state.moved_s)


def test_who_stops_counts_as_moving_for_a_second_and_then_leaves_a_gap() -> None:
    """Joints that went 0.04 heights on average have moved; the box is 80 rows high or so."""
    box = person_of(seen(1, 0, 0.0)).box
    tall_px = box.bottom - box.top

    def at(n: int, by_px: float) -> TwoViews:
        pair = []
        for viewer in (1, 2):
            one = seen(viewer, n, 0.0)
            landmarks = person_of(one).landmarks
            assert landmarks is not None
            places = [(x, y) for x, y in landmarks.joints_px]
            places[3] = (places[3][0] + by_px, places[3][1])
            shown = msgspec.structs.replace(landmarks, joints_px=tuple(places))
            pair.append(changed(one, landmarks=shown))
        return (pair[0], pair[1])

    state, _ = rig_search.step(rig_search.init(1 / HZ, 1.75), at(0, 0.0))
    assert state.posed is not None
    assert state.posed[0] == 0.0
    # one joint of 15 goes by d: the mean of |x| and |y| about the middle is 28 d / 15 / 30
    due_px = 0.04 * tall_px / (28.0 / 15.0 / 30.0)
    for by_px, moves in ((0.97 * due_px, False), (1.03 * due_px, True)):
        later, _ = rig_search.step(state, at(3, by_px))
        assert later.posed is not None
        assert (later.posed[0] > 0.0) is moves
    within, _ = rig_search.step(state, at(15, 0.0))
    assert within.moved_s == pytest.approx(2 / HZ)
    assert not within.gap
    beyond, _ = rig_search.step(within, at(16, 0.0))
    assert beyond.moved_s == within.moved_s
    assert beyond.gap
