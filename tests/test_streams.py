"""Streams of many performances, held against a case worked by hand."""

import json
from pathlib import Path

import numpy as np
import pytest
from acting import perform, performances, standing
from rich.console import Console
from test_exporting import write

from common.body.body import JOINT_NAMES
from recognizer.performance_judge import Event
from recognizer.postures import DensityModel
from recognizer.training import streams
from recognizer.training.learning import train
from recognizer.training.streams import Act, Stream, found, joined
from tritrack.postures.spotting_report import streams as streams_of

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
