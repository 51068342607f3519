"""Teaching by command: takes become a model, and what is odd about them is said."""

from pathlib import Path

import numpy as np
import pytest
from acting import perform
from rich.console import Console

from lab.posture_models.evaluation import Recording
from lab.training import teaching
from lab.training.teaching import line, teach
from lab.training.training import Plan, TrainingError, train_postures
from recognizer.codebook import LearningError
from recognizer.model_file import load
from recognizer.postures import PER_POSTURE

QUIET = Console(quiet=True)
NEW = "kick_left_side"


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Plan:
    """Added to a model of two postures, not to the shipped one, which knows all that can act."""
    people = [
        Recording(f"s{n}", posture, perform(posture, n))
        for posture in ("squat", "walk_toward")
        for n in range(3)
    ]
    monkeypatch.setattr("lab.training.training.recordings", lambda *_: people)
    train_postures([], tmp_path / "two.npz", Plan(None, "default", tmp_path), QUIET)
    return Plan(None, "default", tmp_path, tmp_path / "two.npz")


def filmed(monkeypatch: pytest.MonkeyPatch, *postures: str) -> list[Path]:
    """Takes of these postures, which all come out as the one that is taught."""
    takes = [
        Recording("me", NEW, perform(posture, n), f"take{n}") for n, posture in enumerate(postures)
    ]
    monkeypatch.setattr(teaching, "recordings", lambda *_: takes)
    return [Path(take.clip) for take in takes]


def test_three_takes_make_a_model_that_knows_one_posture_more(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    takes = filmed(monkeypatch, NEW, NEW, NEW)
    facts = teach(NEW, takes, tmp_path / "mine.npz", plan, QUIET)
    model = load(tmp_path / "mine.npz")
    assert list(model.names) == facts["knows"] == ["squat", "walk_toward", NEW]
    assert "me" in model.card.performers
    assert "learnt from 3 takes, 3 postures known" in line(facts)
    assert f"nearest other posture is {facts['rivals'][0]}" in line(facts)


def test_a_known_name_is_learnt_anew_where_that_is_asked_for(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Into the same file; the other postures keep every number."""
    mine, takes = tmp_path / "mine.npz", filmed(monkeypatch, NEW, NEW, NEW)
    teach("bow", takes, mine, plan, QUIET)
    before, own = load(mine), plan._replace(add_to=mine)
    takes = filmed(monkeypatch, *["raise_both_lateral"] * 4)
    with pytest.raises(TrainingError, match="bow is known already: --again"):
        teach("bow", takes, mine, own, QUIET)
    facts = teach("bow", takes, mine, own._replace(again=True), QUIET)
    assert "bow learnt again from 4 takes, 3 postures known" in line(facts)
    after = load(mine)
    assert after.names == before.names == ("squat", "walk_toward", "bow")
    assert after.card.sequences["bow"] == 4
    for array in PER_POSTURE:
        if hasattr(before, array):
            then, now = getattr(before, array), getattr(after, array)
            assert np.array_equal(now[:2], then[:2])
            assert array == "start" or not np.array_equal(now[2], then[2])


def test_a_name_that_is_not_known_cannot_be_learnt_anew(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is misspelt, or another model is meant."""
    takes = filmed(monkeypatch, NEW, NEW, NEW)
    with pytest.raises(TrainingError, match=r"sqat cannot be learnt again: .* squat, walk_toward"):
        teach("sqat", takes, tmp_path / "mine.npz", plan._replace(again=True), QUIET)


def test_a_take_that_differs_is_named_with_what_it_looks_like(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    takes = filmed(monkeypatch, NEW, "squat", NEW, NEW)
    facts = teach(NEW, takes, tmp_path / "mine.npz", plan, QUIET)
    assert "take1 was taken for squat" in line(facts)


def test_takes_that_do_not_agree_write_nothing(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    takes = filmed(monkeypatch, "squat", "walk_toward", "squat")
    with pytest.raises(LearningError, match="not known again"):
        teach(NEW, takes, tmp_path / "mine.npz", plan, QUIET)
    assert not (tmp_path / "mine.npz").exists()


def test_a_file_that_knows_more_is_not_written_over(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second posture of one's own, written where the first is; the first again is no loss."""
    mine, takes = tmp_path / "mine.npz", filmed(monkeypatch, NEW, NEW, NEW)
    teach("bow", takes, mine, plan, QUIET)
    teach("bow", takes, mine, plan, QUIET)
    monkeypatch.setattr(teaching, "recordings", lambda *_: pytest.fail("they were tracked"))
    with pytest.raises(TrainingError, match=r"knows bow, which would be lost: .* --add-to .*mine"):
        teach(NEW, takes, mine, plan, QUIET)
    takes = filmed(monkeypatch, *["raise_both_lateral"] * 3)
    assert teach("jump", takes, mine, plan._replace(add_to=mine), QUIET)["knows"][-2:] == [
        "bow",
        "jump",
    ]


def test_a_file_that_is_no_model_is_not_written_over(plan: Plan, tmp_path: Path) -> None:
    out = tmp_path / "notes.txt"
    out.write_text("an afternoon's work")
    with pytest.raises(TrainingError, match=r"notes\.txt is there already, and is no model"):
        teach(NEW, [], out, plan, QUIET)
    assert out.read_text() == "an afternoon's work"


@pytest.mark.parametrize("posture", ["", "Star Jump", "../up", "9lives", "x" * 60])
def test_what_is_no_name_is_refused(plan: Plan, tmp_path: Path, posture: str) -> None:
    with pytest.raises(TrainingError, match="is no name of a posture"):
        teach(posture, [], tmp_path / "mine.npz", plan, QUIET)


def test_too_few_takes_are_refused_before_any_is_tracked(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(teaching, "recordings", lambda *_: pytest.fail("they were tracked"))
    with pytest.raises(TrainingError, match="name at least 3 clips of kick_left_side"):
        teach(NEW, [Path("a"), Path("b")], tmp_path / "mine.npz", plan, QUIET)


def test_one_take_named_twice_is_refused_before_any_is_tracked(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(teaching, "recordings", lambda *_: pytest.fail("they were tracked"))
    with pytest.raises(TrainingError, match="/a is named twice"):
        teach(NEW, [Path("a"), Path("b"), Path("b/../a")], tmp_path / "mine.npz", plan, QUIET)
