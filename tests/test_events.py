"""Performances found in a stream that nobody cuts."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from acting import perform, performances, standing

from lab.posture_models.learning import extended, train
from recognizer import events
from recognizer.events import finish, init, step
from recognizer.features import bearings
from recognizer.path_network import CHANGE, COUNT, ENTER, EXIT, LAST, ONSET, PathNetwork, advance
from recognizer.performance_judge import Event
from recognizer.postures import STATES, DensityModel

SHOWN = ("squat", "walk_toward", "raise_right_lateral", "kick_right_forward")
"""Some of the fifteen: a network of few is as good an example, and faster."""
SHAKE = np.repeat([0.7, 0.002], [17, 3])
"""Of a person who stands: degrees, then leg lengths."""


def learnt(*names: str) -> DensityModel:
    """A model of performances that begin in standing."""
    shown = performances(range(6))
    model = train({name: [begun(rows) for rows in shown[name]] for name in names})
    assert isinstance(model, DensityModel)
    return model


def begun(rows: np.ndarray) -> np.ndarray:
    """The same with a moment of standing before, and the way there."""
    return np.concatenate([still(5, rows[0, 17:]), rows])


def still(frames: int, place: np.ndarray | None = None) -> np.ndarray:
    rows = standing(frames) + np.random.default_rng(frames).normal(0.0, 1.0, (frames, 20)) * SHAKE
    if place is not None:
        rows[:, 17:] = place
    return np.asarray(rows)


@pytest.fixture(scope="module")
def model() -> DensityModel:
    return learnt(*SHOWN)


@pytest.fixture(scope="module")
def many() -> DensityModel:
    return learnt(*SHOWN, "kick_left_side")


def told(model: DensityModel, *pieces: np.ndarray) -> list[tuple[Event, int]]:
    """The events of a stream, as they are in the end, with the frame in which each was last told;
    everybody moves on from where they are."""
    state, events = init(model), dict[int, tuple[Event, int]]()
    for frame, row in enumerate(np.concatenate(pieces)):
        state, doing = step(state, row)
        if doing.event:
            events[doing.event.first] = (doing.event, frame)
    return list(events.values())


def ended(model: DensityModel, *pieces: np.ndarray) -> Event | None:
    """What the end of a stream has to tell."""
    state = init(model)
    for row in np.concatenate(pieces):
        state, _ = step(state, row)
    return finish(state)


@pytest.mark.parametrize("posture", ["squat", "raise_right_lateral", "kick_right_forward"])
def test_a_performance_is_one_event_with_its_beginning_and_end(
    model: DensityModel, posture: str
) -> None:
    """Nobody cuts the stream: two seconds of standing, the posture, two of standing."""
    events = told(model, still(30), perform(posture, performer=9), still(30))
    assert [event.name for event, _ in events] == [posture]
    event, frame = events[0]
    assert event.first == pytest.approx(30, abs=6)
    assert event.last == pytest.approx(69, abs=6)
    assert frame <= 69 + 9
    assert event.posterior > 0.9


def rests(model: DensityModel, posture: str, frames: int) -> list[tuple[Event, int]]:
    """What is told of a posture that is performed five times with so many frames of standing after
    each."""
    once = np.concatenate([perform(posture, performer=9), still(frames)])
    return told(model, still(30), *[once] * 5, still(30))


@pytest.mark.parametrize("posture", ["squat", "raise_right_lateral"])
def test_five_performances_with_a_rest_between_them_are_five_events(
    model: DensityModel, posture: str
) -> None:
    """Twelve frames, 0.8 s."""
    events = [event for event, _ in rests(model, posture, 12)]
    assert [event.name for event in events] == [posture] * 5
    onsets = 30 + 52 * np.arange(5)
    assert [event.first for event in events] == pytest.approx(onsets, abs=6)
    assert [event.last for event in events] == pytest.approx(onsets + 39, abs=6)


def test_a_performance_that_pauses_is_one_event(model: DensityModel) -> None:
    """A third of a second, four times: it is over, and judged, after each of its five parts."""
    (only,) = [event for event, _ in rests(model, "kick_right_forward", 5)]
    assert only.name == "kick_right_forward"
    assert (only.first, only.last) == pytest.approx((30, 30 + 5 * 45 - 6), abs=6)
    assert only.times == 10, "each performance is two kicks"


@pytest.mark.parametrize("rest_frames", [5, 8, 10, 14, 20])
@pytest.mark.parametrize(
    ("posture", "times"), [("kick_right_forward", 20), ("kick_left_side", 20), ("squat", 20)]
)
def test_every_repetition_counts_whatever_the_pause_between_them(
    many: DensityModel, posture: str, times: int, rest_frames: int
) -> None:
    """Ten performances of two bends each, in however many events."""
    once = np.concatenate([perform(posture, performer=9), still(rest_frames)])
    events = [event for event, _ in told(many, still(30), *[once] * 10, still(30))]
    assert {event.name for event in events} == {posture}
    assert sum(event.times for event in events) == times


def test_what_is_under_way_counts_from_before_the_pause(model: DensityModel) -> None:
    kick = perform("kick_right_forward", performer=9)
    state, counts = init(model), []
    for row in np.concatenate([still(30), kick, still(5), kick]):
        state, doing = step(state, row)
        counts.append(doing.times)
    assert max(counts) == 4


def test_a_performance_is_told_that_ends_just_before_the_stream_does(model: DensityModel) -> None:
    """A third of a second; and one that the end cuts off in its second half."""
    squat = perform("squat", performer=9)
    for seen in ([squat, still(5)], [squat], [squat[:30]]):
        event = ended(model, still(30), *seen)
        assert event is not None
        assert event.name == "squat"
        assert event.first == pytest.approx(30, abs=6)
        assert event.last == pytest.approx(30 + len(seen[0]) - 1, abs=6)


def test_the_end_of_a_stream_tells_no_more_than_was_performed(model: DensityModel) -> None:
    squat, kick = (perform(posture, performer=9) for posture in ("squat", "kick_right_forward"))
    assert finish(init(model)) is None
    assert ended(model, still(30)) is None
    assert ended(model, still(30), squat[:6]) is None
    assert ended(model, still(30), squat, still(30)) is None, "it was told before"
    both = ended(model, still(30), kick, still(5), kick)
    assert both is not None
    assert both.first == pytest.approx(30, abs=6), "the last one gone on"
    assert both.times == 4


def test_a_repetition_goes_to_the_far_states_and_back_to_the_near_ones(many: DensityModel) -> None:
    """By the model's own poses: the far ones are away from standing, the near ones as standing."""
    network = PathNetwork(many)
    away = np.linalg.norm(many.mean - many.rest_mean, axis=2)
    for posture in ("kick_right_forward", "kick_left_side", "squat"):
        p = many.names.index(posture)
        far, near = (away[p][network.side[p] == side] for side in (1, -1))
        assert far.min() > 2 * near.max()


def test_standing_is_no_event(model: DensityModel) -> None:
    assert told(model, still(200)) == []


def test_a_posture_that_was_not_learnt_is_rejected() -> None:
    """The stream of the test above, by a model that never saw the kick."""
    model = learnt("squat", "walk_toward", "raise_right_lateral")
    kick = perform("kick_right_forward", performer=9)
    assert told(model, still(30), kick, still(30)) == []
    lateral = perform("raise_both_lateral", performer=9)
    assert told(model, still(30), lateral, still(30)) == []


def test_a_posture_that_is_taught_later_is_told_too() -> None:
    """Three performances, added to a model that is there."""
    known = learnt("squat", "walk_toward", "raise_right_lateral")
    kicks = [begun(rows) for rows in performances(range(3))["kick_right_forward"]]
    model = extended(known, {"kick_right_forward": kicks})
    assert isinstance(model, DensityModel)
    events = told(model, still(30), perform("kick_right_forward", performer=9), still(30))
    assert [event.name for event, _ in events] == ["kick_right_forward"]


def test_a_part_of_a_posture_is_not_the_posture(model: DensityModel) -> None:
    """Half a second of it."""
    assert told(model, still(30), perform("squat", performer=9)[:6], still(30)) == []


def test_nothing_begins_before_somebody_stood(model: DensityModel) -> None:
    """A person who comes in squatting is not told."""
    squat = perform("squat", performer=9)
    assert told(model, squat[10:30]) == []


def test_frames_without_a_pose_add_nothing(model: DensityModel) -> None:
    squat, nowhere = perform("squat", performer=9), np.full((2, 20), np.nan)
    plain = told(model, still(30), squat, still(30))
    gaps = told(model, still(30), squat[:20], nowhere, squat[20:], still(30))
    assert [event.name for event, _ in gaps] == [event.name for event, _ in plain]
    assert gaps[0][0].last == plain[0][0].last + 2


@pytest.mark.parametrize("absent", [15, 900], ids=["a second", "a minute"])
def test_a_performance_ends_with_who_leaves_in_its_midst(model: DensityModel, absent: int) -> None:
    """What somebody does after a second in which nobody was followed is no part of it."""
    squat, nowhere = perform("squat", performer=9), np.full((absent, 20), np.nan)
    cut = len(squat) * 2 // 3
    events = told(model, still(30), squat[:cut], nowhere, still(30), squat, still(30))
    assert [event.name for event, _ in events] == ["squat"]
    assert events[0][0].first > 30 + cut + absent


def test_a_step_leaves_the_state_it_was_given_alone(model: DensityModel) -> None:
    state = init(model)
    for row in still(30):
        state, _ = step(state, row)
    before = replace(state, score=state.score.copy())
    step(state, perform("squat", performer=9)[0])
    assert np.array_equal(state.score, before.score)


def test_the_best_path_is_that_of_all_paths_tried() -> None:
    """Two postures of two states, standing and the filler, five frames: every path is scored by
    hand, Rabiner's section III B by brute force."""
    rng = np.random.default_rng(0)
    transition = rng.dirichlet((1.0, 1.0), (2, 2))
    logs = rng.normal(0.0, 6.0, (5, 6))
    turn = np.zeros((2, 2), np.int64)
    score = np.array([-np.inf] * 5 + [0.0])
    record, over = np.zeros((6, LAST), np.int64), np.full((6, LAST + 1), -1)
    for frame, emission in enumerate(logs):
        score, record, over = advance(
            score, record, over, emission, np.log(transition), turn, frame, True
        )
    best = np.full(6, -np.inf)
    paths = np.stack(np.meshgrid(*[np.arange(6)] * 5, indexing="ij"), axis=-1).reshape(-1, 5)
    cost = np.array([[move(transition, i, j) for j in range(6)] for i in range(6)])
    ways = np.concatenate([np.full((len(paths), 1), 5), paths], axis=1)
    totals = cost[ways[:, :-1], ways[:, 1:]].sum(axis=1) + logs[np.arange(5), paths].sum(axis=1)
    np.maximum.at(best, paths[:, -1], totals)
    assert score == pytest.approx(best - best.max(), abs=1e-9)


def move(transition: np.ndarray, i: int, j: int) -> float:
    """What it costs a path to go from one state of the network to another."""
    if i < 4 and j < 4:
        inside = i // 2 == j // 2
        return float(np.log(transition[i // 2, i % 2, j % 2])) if inside else -np.inf
    if i >= 4 and j >= 4:
        return 0.0 if i == j else -CHANGE
    return -ENTER if i >= 4 else -EXIT


def test_what_a_frame_shows_is_its_vector_and_how_fast_limbs_turn(
    model: DensityModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By all rows so far; how far the body goes counts twice as much as how far limbs turn."""
    heard: list[tuple[np.ndarray, float]] = []

    def emissions(seen: np.ndarray, speed: float, *_: np.ndarray) -> np.ndarray:
        heard.append((seen.copy(), speed))
        return np.zeros(5 * len(model.names) + 2)

    monkeypatch.setattr(events, "emissions", emissions)
    rows = perform("walk_toward", performer=9)[:20]
    state = init(model)
    for row in rows:
        state, _ = step(state, row)
    every = bearings(rows)
    for at, (seen, speed) in enumerate(heard):
        assert seen == pytest.approx(every[at])
        change = every[at] - every[max(at - events.SPEED_FRAMES, 0)]
        change[-3:] = 2.0 * every[at, -3:]
        assert speed == pytest.approx(np.linalg.norm(change))


def scripted(model: DensityModel, best: int, **parts: Any) -> events.State:
    """A state whose best path ends in a state of the network."""
    state = events.init(model)
    score = np.full(len(state.score), -5.0)
    score[best] = 0.0
    return replace(state, score=score, **parts)


STAND, UNKNOWN = -2, -1
SQUAT = Event("squat", 20, 29, 0.75, 2)


@pytest.mark.parametrize(
    ("now", "judged", "told"), [(31, -1, 0), (32, -1, 1), (40, 29, 1), (40, 30, 0)]
)
def test_a_performance_is_judged_once_two_frames_after_its_end(
    model: DensityModel, monkeypatch: pytest.MonkeyPatch, now: int, judged: int, told: int
) -> None:
    """It began in frame 20 and ended in frame 30."""
    calls: list[int] = []
    over = np.full((len(events.init(model).score), LAST + 1), -1)
    over[STAND, [ONSET, LAST]] = 20, 30

    def judging(state: events.State, given: np.ndarray) -> Any:
        calls.append(int(given[LAST]))
        return (SQUAT,), SQUAT

    monkeypatch.setattr(events, "_further", lambda state, new, now: state)
    monkeypatch.setattr(events, "_judged", judging)
    state = scripted(model, STAND, over=over, next_frame=now, judged=judged)
    after, doing = events.step(state, standing(1)[0])
    assert calls == [30] * told
    assert (doing.event, doing.name, doing.times) == (SQUAT if told else None, "", 0)
    assert (after.judged, after.told) == ((30, (SQUAT,)) if told else (judged, ()))
    assert after.next_frame == now + 1


def test_what_is_under_way_is_named_and_counted_with_its_parts_before(
    model: DensityModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the second posture, begun 9 frames after the last event of its name, and 10 after."""
    monkeypatch.setattr(events, "_further", lambda state, new, now: state)
    name = model.names[1]
    part = Event(name, 20, 29, 0.75, 2)
    for onset, times in ((38, 5), (39, 3)):
        record = np.zeros((len(events.init(model).score), LAST), np.int64)
        record[STATES + 2, [ONSET, COUNT]] = onset, 3
        state = scripted(model, STATES + 2, record=record, told=(part,), next_frame=44)
        assert events.step(state, standing(1)[0])[1] == (name, times, None)
    other = replace(state, told=(part._replace(name=model.names[0]),))
    assert events.step(other, standing(1)[0])[1].times == 3


def test_the_end_judges_what_is_under_way_to_the_last_frame_or_what_was_not_told(
    model: DensityModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(events, "_judged", lambda state, over: ((), over.tolist()))
    size = len(events.init(model).score)
    record, over = np.zeros((size, LAST), np.int64), np.full((size, LAST + 1), -1)
    record[3, ONSET], over[UNKNOWN, [ONSET, LAST]] = 17, (5, 12)
    frames = tuple(range(10, 26))
    cut: Any = events.finish(scripted(model, 3, record=record, over=over, frames=frames))
    assert (cut[ONSET], cut[LAST]) == (17, 25)
    state = scripted(model, UNKNOWN, record=record, over=over, frames=frames, judged=11)
    untold: Any = events.finish(state)
    assert (untold[ONSET], untold[LAST]) == (5, 12)
    assert events.finish(replace(state, judged=12)) is None


def judged(
    model: DensityModel,
    monkeypatch: pytest.MonkeyPatch,
    event: Event | None,
    told: tuple[Event, ...] = (),
    before: int = -1,
) -> Any:
    """What becomes of a performance from frame 40 to 52 of which the last ten frames are kept."""
    rows = np.arange(12.0)[:, None] * np.ones(20)
    seen: list[list[float]] = []

    def judging(_: Any, __: Any, rows: np.ndarray) -> Event | None:
        seen.append(rows[:, 0].tolist())
        return event

    monkeypatch.setattr(events, "event_of", judging)
    over = np.full(LAST + 1, -1)
    over[[ONSET, LAST]] = 40, 52
    frames = tuple(range(43, 55))
    state = scripted(model, STAND, told=told, rows=rows, frames=frames, judged=before)
    found = events._judged(state, over)
    assert seen == [[float(n) for n in range(10)]]
    return found


def test_a_performance_that_goes_on_takes_the_place_of_its_parts(
    model: DensityModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It began with the first, was gone through as often as both, and is as sure as the least."""
    now = Event("squat", 40, 52, 0.9, 3)
    close, far = Event("squat", 20, 31, 0.75, 2), Event("squat", 20, 30, 0.75, 2)
    assert judged(model, monkeypatch, now, (close,)) == (
        (close, now),
        Event("squat", 20, 52, 0.75, 5),
    )
    assert judged(model, monkeypatch, now, (far,)) == ((now,), now)
    other = close._replace(name="bow")
    assert judged(model, monkeypatch, now, (other,)) == ((now,), now)
    within = Event("squat", 40, 45, 0.6, 1)
    assert judged(model, monkeypatch, now, (close, within)) == (
        (close, now),
        Event("squat", 20, 52, 0.75, 5),
    )
    later = now._replace(first=44)
    assert judged(model, monkeypatch, now, (within._replace(first=44),)) == ((later,), later)


def test_what_is_no_performance_or_overlaps_another_is_not_told(
    model: DensityModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The parts so far are kept only where it is no later than what was judged."""
    told = (Event("bow", 30, 40, 0.8, 1),)
    now = Event("squat", 40, 52, 0.9, 3)
    assert judged(model, monkeypatch, None, told, before=39) == ((), None)
    assert judged(model, monkeypatch, None, told, before=40) == (told, None)
    assert judged(model, monkeypatch, now, told, before=40) == (told, None)
    apart = (told[0]._replace(last=39),)
    assert judged(model, monkeypatch, now, apart) == ((now,), now)


def test_frames_go_on_to_be_counted_where_nobody_is_seen(model: DensityModel) -> None:
    """Also past the frame from which on everything begins anew, and a pose begins the count."""
    state = replace(events.init(model), next_frame=70)
    for missed in range(1, 40):
        state, doing = events.step(state, None)
        assert (state.next_frame, state.missed, doing) == (70 + missed, missed, events.NOTHING)
    state, _ = events.step(state, standing(1)[0])
    assert (state.next_frame, state.missed, state.frames) == (110, 0, (109,))
