"""Posture models from runs."""

import io
from pathlib import Path

import numpy as np
import pytest
from acting import perform
from rich.console import Console

from lab.posture_models.evaluation import Recording
from lab.training import training
from lab.training.training import Plan, train_postures
from recognizer.codebook import LearningError
from recognizer.model_file import ModelError, load

QUIET = Console(quiet=True)
POSTURES = ("raise_right_lateral", "squat")


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[Recording]:
    """Two people, two postures; what a command reads is this list."""
    people = [
        Recording(who, posture, perform(posture, number))
        for number, who in enumerate(("s02", "s03"))
        for posture in POSTURES
    ]
    monkeypatch.setattr(training, "recordings", lambda *_: people)
    return people


def learn(out: Path) -> dict[str, object]:
    return train_postures([], out, Plan(None, "default", out.parent), QUIET)


def test_a_model_learns_the_postures_that_the_clips_name(
    shown: list[Recording], tmp_path: Path
) -> None:
    facts = learn(tmp_path / "deep" / "m.npz")
    assert facts["sequences"] == {"raise_right_lateral": 2, "squat": 2}
    model = load(tmp_path / "deep" / "m.npz", POSTURES)
    assert list(model.card.performers) == facts["performers"] == ["s02", "s03"]


def test_a_model_that_cannot_be_written_is_named(shown: list[Recording], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ModelError, match=r"cannot write the model .*file"):
        learn(tmp_path / "file" / "m.npz")


def test_a_motion_too_short_to_learn_from_is_said(shown: list[Recording], tmp_path: Path) -> None:
    shown[:] = [shown[0]._replace(rows=np.empty((0, 20)))]
    with pytest.raises(LearningError, match="none of 1 sequences has 5 frames"):
        learn(tmp_path / "m.npz")


def test_a_model_of_few_takes_or_one_posture_is_warned_of(
    shown: list[Recording], tmp_path: Path
) -> None:
    def said() -> str:
        console = Console(file=io.StringIO(), width=500)
        train_postures([], tmp_path / "m.npz", Plan(None, "default", tmp_path), console)
        assert isinstance(console.file, io.StringIO)
        return console.file.getvalue()

    assert "warning: less than 3 takes of raise_right_lateral, squat: record more" in said()
    shown[:] = [each for each in shown if each.posture == "squat"]
    assert "warning: only squat is learnt: such a model names any motion so" in said()
    shown[:] = [Recording("s02", name, perform(name, n)) for name in POSTURES for n in range(3)]
    assert said() == ""
