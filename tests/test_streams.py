"""Streams of many performances, held against a case worked by hand."""

import json
from pathlib import Path

import numpy as np
import pytest
from acting import perform, performances, standing
from rich.console import Console
from test_exporting import write

from common.body.body import JOINT_NAMES
from common.config.part_settings import RecognizerSettings
from lab.posture_models import streams
from lab.posture_models.learning import train
from lab.posture_models.streams import Act, Stream, found, joined
from lab.postures import spotting_report
from lab.postures.spotting_report import streams as streams_of
from lab.training.training import TrainingError
from recognizer.performance_judge import Event
from recognizer.postures import DensityModel

ACTS = (Act("squat", 10, 40), Act("walk_toward", 60, 90), Act("kick_left_side", 120, 150))


def test_each_performance_counts_once_and_all_else_is_false(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One found late, one told twice, one misnamed, one of nothing: two found, three false."""
    told = [
        (Event("squat", 12, 41, 1.0, 1), 46),
        (Event("walk_toward", 61, 75, 1.0, 1), 80),
        (Event("walk_toward", 76, 90, 1.0, 1), 96),
        (Event("squat", 100, 110, 1.0, 1), 115),
        (Event("kick_right_forward", 120, 150, 1.0, 1), 156),
    ]
    monkeypatch.setattr(streams, "spotted", lambda _model, _rows: told)
    model = train({name: performances(range(2))[name] for name in ("squat", "walk_toward")})
    assert isinstance(model, DensityModel)
    result = found(model, Stream("one", np.zeros((200, 20)), ACTS))
    assert result.delays == (6, -10)
    assert result.missed == (ACTS[2],)
    assert [event.first for event in result.false] == [76, 100, 120]


def test_joined_performances_stand_between() -> None:
    """Every posture once, whole, and between two of them at least half a second of stance."""
    given = [
        (posture, np.concatenate([standing(1), perform(posture, performer=3)]))
        for posture in ("squat", "raise_both_lateral", "kick_left_side")
    ]
    stream = joined("r", given, seed=1)
    assert sorted(act.name for act in stream.acts) == sorted(name for name, _ in given)
    for act, after in zip(stream.acts, (*stream.acts[1:], None), strict=True):
        assert act.last - act.first >= 30
        pause = stream.rows[act.last + 3 : after.first if after else None, :17]
        assert len(pause) >= 5
        assert np.abs(pause - standing(1)[0, :17]).max() < 25
    steps = np.abs(np.diff(stream.rows[:, [17, 19]], axis=0))
    assert steps.max() < 0.1


def test_a_stream_is_the_same_again() -> None:
    given = [("squat", perform("squat", performer=3)), ("walk_toward", perform("walk_toward", 3))]
    assert np.array_equal(joined("r", given, 5).rows, joined("r", given, 5).rows)


def test_a_stream_of_60_frames_a_second_is_told_in_the_models_own_frames(tmp_path: Path) -> None:
    """P1: its performance of two thirds of a second lasts ten of them."""
    n = 80
    arrays = {
        "frame": np.arange(n),
        "time_s": np.arange(n) / 60,
        "joints_m": np.random.default_rng(0).normal(size=(n, 15, 3)),
        "joints_px": np.zeros((n, 2, 15, 2)),
        "angles_deg": np.zeros((n, 17)),
        "confidence": np.ones((n, 15)),
        "status": np.full(n, "tracking"),
        "views": np.full(n, "both"),
        "score": np.ones((n, 2)),
        "joint_names": np.array(JOINT_NAMES),
    }
    acts = [{"name": "squat", "first": 20, "last": 59}, {"name": "squat", "first": 70, "last": 99}]
    write(tmp_path / "run", arrays, json.dumps({"acts": acts}))
    (stream,) = streams_of([tmp_path / "run"], None, Console(quiet=True))
    assert len(stream.rows) == pytest.approx(20, abs=1)
    first, cut = stream.acts
    assert first.last - first.first == pytest.approx(10, abs=1)
    assert first.first == pytest.approx(5, abs=1)
    assert cut.last == len(stream.rows) - 1, "the run was cut short"


def test_an_event_is_told_when_it_was_first_told_as_it_was_last_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Told at frame 2, gone on with at 5; another comes with the end, after seven frames."""
    walk = Event("walk_toward", 1, 2, 0.9, 1)
    longer, last = walk._replace(last=4, times=3), Event("squat", 5, 6, 0.8, 1)
    said = {2: walk, 5: longer}
    seen = []

    class Doing:
        def __init__(self, event: Event | None) -> None:
            self.event = event

    def step(state: int, row: np.ndarray) -> tuple[int, Doing]:
        seen.append(float(row[0]))
        return state + 1, Doing(said.get(state))

    monkeypatch.setattr("recognizer.events.init", lambda model: 0)
    monkeypatch.setattr("recognizer.events.step", step)
    monkeypatch.setattr("recognizer.events.finish", lambda state: last if state == 7 else None)
    rows = np.arange(7.0)[:, None]
    assert streams.spotted(None, rows) == [(longer, 2), (last, 6)]  # type: ignore[arg-type]
    assert seen == rows[:, 0].tolist()


def test_a_performance_is_told_by_the_event_that_overlaps_it_most_however_little(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From frame 39 to 62: of the squat till 40 it shares 1, of the walk from 60 on 2."""
    told = [
        (Event("walk_toward", 39, 62, 1.0, 1), 95),
        (Event("kick_left_side", 150, 160, 1.0, 1), 161),
    ]
    monkeypatch.setattr(streams, "spotted", lambda _model, _rows: told)
    result = found(None, Stream("one", np.zeros((200, 20)), ACTS))  # type: ignore[arg-type]
    assert (result.stream, result.frames, result.performances) == ("one", 200, 3)
    assert result.delays == (5,)
    assert result.missed == (ACTS[0], ACTS[2])
    assert [event.first for event in result.false] == [150], "touching is not overlapping"


class Steps:
    """Draws of a pause of 11 frames, without sway."""

    def __init__(self) -> None:
        self.sizes: list[np.ndarray] = []

    def integers(self, low: int, high: int) -> int:
        assert (low, high) == (15, 60)
        return 11

    def normal(self, middle: float, size: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
        self.sizes.append(size)
        return np.zeros(shape)


def test_a_pause_goes_the_short_way_round_to_the_next_stance_within_eight_frames() -> None:
    before, after = np.zeros(20), np.zeros(20)
    before[0], after[0] = 350.0, 14.0
    before[1], after[1] = 10.0, 50.0
    before[17], after[17] = 0.2, 0.6
    steps = Steps()
    rows = streams._pause(before, after, steps)  # type: ignore[arg-type]
    way = [*(np.arange(1, 9) / 8), 1.0, 1.0, 1.0]
    assert rows[:, 0] == pytest.approx([350 + 24 * share for share in way])
    assert rows[:, 1] == pytest.approx([10 + 40 * share for share in way])
    assert rows[:, 17] == pytest.approx([0.2 + 0.4 * share for share in way])
    assert steps.sizes[0].tolist() == [1.0] * 17 + [0.002] * 3


def run_arrays(n: int, hz: float, place: float) -> dict[str, np.ndarray]:
    """A body whose pelvis stands at a place, tracked in all frames but the first two."""
    rng = np.random.default_rng(0)
    status = np.full(n, "tracking", dtype="<U9")
    status[:2] = "empty"
    joints_m = rng.normal(size=(1, 15, 3)).repeat(n, axis=0)
    return {
        "frame": np.arange(n),
        "time_s": np.arange(n) / hz,
        "joints_m": joints_m,
        "joints_px": np.zeros((n, 2, 15, 2)),
        "angles_deg": np.full((n, 17), place),
        "confidence": np.ones((n, 15)),
        "status": status,
        "views": np.full(n, "both"),
        "score": np.ones((n, 2)),
        "joint_names": np.array(JOINT_NAMES),
    }


def test_single_performances_are_joined_performer_by_performer_and_streams_come_first(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a single performance the last window is taken; what is not tracked has no pose."""
    given = {
        "bob_squat": (70, {"performer": "bob", "posture_meant": "squat"}),
        "whole": (5, {"acts": [{"name": "squat", "first": 1, "last": 3}]}),
        "ann_kick": (8, {"performer": "ann", "posture_meant": "kick_left_side"}),
        "bob_kick": (9, {"performer": "bob", "posture_meant": "kick_left_side"}),
    }
    for place, (name, (n, facts)) in enumerate(given.items()):
        write(tmp_path / name, run_arrays(n, 15.0, 10.0 * place), json.dumps(facts))
    noted = []

    def joining(name: str, performances: list[tuple[str, np.ndarray]], seed: int) -> Stream:
        noted.append((name, performances, seed))
        return Stream(name, np.zeros((1, 20)), ())

    monkeypatch.setattr(spotting_report, "joined", joining)
    paths = [tmp_path / name for name in given]
    found = streams_of(paths, None, Console(quiet=True))
    assert [one.name for one in found] == ["whole", "ann", "bob"]
    assert found[0].acts == (Act("squat", 1, 3),)
    assert np.isnan(found[0].rows[:2]).all()
    assert np.isfinite(found[0].rows[2:]).all()
    assert found[0].rows[2:, 0].tolist() == [10.0] * 3
    assert [(name, [posture for posture, _ in held], seed) for name, held, seed in noted] == [
        ("ann", ["kick_left_side"], 0),
        ("bob", ["squat", "kick_left_side"], 0),
    ]
    window = RecognizerSettings().window_frames
    assert [len(rows) for _, rows in noted[1][1]] == [window, 9]
    assert np.isfinite(noted[1][1][0][1]).all()
    assert np.isnan(noted[1][1][1][1][:2]).all()


def test_a_run_that_names_nothing_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "run", run_arrays(4, 15.0, 0.0), json.dumps({"performer": "ann"}))
    with pytest.raises(TrainingError, match="run names neither acts nor a posture"):
        streams_of([tmp_path / "run"], None, Console(quiet=True))
