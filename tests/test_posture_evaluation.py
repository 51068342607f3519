"""The report on unseen people, held against outcomes that are known beforehand."""

import json
from contextlib import nullcontext
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import msgspec
import pytest
from acting import perform
from rich.console import Console
from typed import instead

from lab.posture_models.evaluation import Recording
from lab.posture_models.learning import train
from lab.postures import posture_evaluation
from lab.postures.posture_evaluation import Plan, evaluate_postures
from lab.postures.posture_split import EACH_IN_TURN
from lab.training.training import TrainingError
from recognizer.codebook import LearningError
from recognizer.model_file import save
from runtime.faults import code_of

QUIET = Console(quiet=True)
DANCED = (
    *(("squat", "squat"), ("raise_right_lateral", "raise_right_lateral")),
    ("bow", "swing_both_backforth"),
)
"""Names, and the motions that are danced under them."""


def of(performer: str, number: int) -> list[Recording]:
    """Three motions; the bow is one of ours that no list names."""
    return [Recording(performer, name, perform(motion, number)) for name, motion in DANCED]


def shown(given: list[Recording], patch: pytest.MonkeyPatch) -> None:
    """What clips say of themselves, and what tracking made of them, is this list."""
    patch.setattr(posture_evaluation, "announced", lambda *_: given)
    patch.setattr(posture_evaluation, "recordings", lambda *_: given)


@pytest.fixture
def people(monkeypatch: pytest.MonkeyPatch) -> list[Recording]:
    """Ann, bob and cas, of whom cas calls a squat a bow and a bow a squat."""
    cas = [
        one._replace(posture={"squat": "bow", "bow": "squat"}.get(one.posture, one.posture))
        for one in of("cas", 3)
    ]
    everybody = [*of("ann", 1), *of("bob", 2), *cas]
    shown(everybody, monkeypatch)
    monkeypatch.setattr(posture_evaluation, "spread", nullcontext)
    return everybody


def evaluate(out: Path, split: str) -> dict[str, Any]:
    """The default recogniser's part of the report."""
    report = evaluate_postures([], out, Plan(split, ("default",)), QUIET)
    result: dict[str, Any] = report["recognizers"]["default"]
    return result


def test_who_is_tested_is_named_by_a_model_of_the_others(
    people: list[Recording], tmp_path: Path
) -> None:
    """P59: ann's word for a squat is not cas's, so 1 of cas's 3 is right; bob's are all."""
    report = evaluate(tmp_path, "ann:bob,c*")
    assert (report["all"]["correct"], report["all"]["tested"]) == (4, 6)
    assert report["postures"]["squat"]["correct"] == 1
    assert report["confusion"]["named"] == ["raise_right_lateral", "squat", "bow", ""]
    assert report["confusion"]["counts"] == [[2, 0, 0, 0], [0, 1, 1, 0], [0, 1, 1, 0]]


def test_the_files_hold_what_the_report_says(people: list[Recording], tmp_path: Path) -> None:
    report = evaluate(tmp_path / "new" / "deep", EACH_IN_TURN)
    whole = json.loads((tmp_path / "new" / "deep" / "report.json").read_text())
    written = whole["recognizers"]["default"]
    assert written == json.loads(json.dumps(report))
    assert written["all"]["tested"] == 9
    low, high = written["all"]["interval_95"]
    assert low < written["all"]["share"] < high


def test_a_posture_unseen_in_training_is_rejected_not_named(
    people: list[Recording], tmp_path: Path
) -> None:
    """A model of arm raising alone knows bob's, and neither his squat nor his bow."""
    people[:] = [*[one for one in of("ann", 1) if "raise" in one.posture], *of("bob", 2)]
    result = evaluate(tmp_path, "ann:bob")
    assert (result["all"]["correct"], result["all"]["tested"]) == (1, 1)
    assert result["rejection"]["known"] == {"tested": 1, "no_name": 0}
    assert result["rejection"]["unknown"]["squat"] == {"tested": 1, "no_name": 1}
    assert result["rejection"]["unknown"]["bow"] == {"tested": 1, "no_name": 1}


class Cells(HTMLParser):
    """The texts of a page's table cells, and every address that it would fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.cells: list[str] = []
        self.fetched: list[str] = []
        self.pictures: list[str] = []
        self.inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.inside = tag == "td"
        self.pictures += [value or "" for name, value in attrs if name == "alt"]
        given = [value or "" for name, value in attrs if name in ("src", "href")]
        self.fetched += [value for value in given if not value.startswith("data:")]

    def handle_data(self, data: str) -> None:
        if self.inside:
            self.cells.append(data.strip())


def test_the_page_shows_shares_and_pictures_and_fetches_nothing(
    people: list[Recording], tmp_path: Path
) -> None:
    evaluate(tmp_path, "ann:bob,cas")
    page = Cells()
    page.feed((tmp_path / "report.html").read_text())
    assert "4/6" in page.cells
    assert not page.fetched
    assert page.pictures == ["confusion matrix of the default recogniser"]
    assert (tmp_path / "confusion_default.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("split", "reason"),
    [
        ("ann", "the split 'ann' must be leave-one-performer-out or name performers"),
        ("ann:zoe", "must be leave-one-performer-out or name performers that are there"),
        ("ann,bob:bob", "bob: in training and in test"),
    ],
)
def test_a_split_that_measures_nothing_is_refused(
    people: list[Recording], tmp_path: Path, split: str, reason: str
) -> None:
    with pytest.raises((TrainingError, LearningError), match=reason):
        evaluate(tmp_path, split)


def test_one_performer_cannot_be_left_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    shown(of("ann", 1), monkeypatch)
    with pytest.raises(TrainingError, match="none is left to learn from"):
        evaluate(tmp_path, EACH_IN_TURN)


@pytest.mark.parametrize(
    ("split", "reason"),
    [
        (EACH_IN_TURN, "none of the postures that are tested is shown by anybody who is learnt"),
        ("ann:zoe", "name performers that are there"),
        ("ann,bob:bob", "bob: in training and in test"),
    ],
)
def test_what_would_measure_nothing_is_refused_before_anything_is_tracked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, split: str, reason: str
) -> None:
    """Two people who share no posture: whoever is left out, nobody showed it to the models."""

    def tracked(*_: object) -> None:
        raise AssertionError("a clip was tracked")

    squat, arm, bow = of("ann", 1)
    alone = [squat, arm, bow._replace(performer="bob")]
    monkeypatch.setattr(posture_evaluation, "announced", lambda *_: alone)
    monkeypatch.setattr(posture_evaluation, "recordings", tracked)
    with pytest.raises((TrainingError, LearningError), match=reason):
        evaluate(tmp_path, split)


@pytest.mark.parametrize(("performers", "refused"), [(("bob", "zoe"), True), (("zoe",), False)])
def test_a_model_is_not_tested_on_who_it_was_learnt_from(
    people: list[Recording],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    performers: tuple[str, ...],
    refused: bool,
) -> None:
    """Before anything is tracked: what it would say of them is no measure of unseen people."""
    model = tmp_path / "model.npz"
    learnt = train({name: [perform(motion, n) for n in range(3)] for name, motion in DANCED})
    save(replace(learnt, card=msgspec.structs.replace(learnt.card, performers=performers)), model)
    tracked = instead(monkeypatch, "lab.postures.posture_evaluation.recordings", people)
    plan = Plan(recognizers=("default",), model=model)
    with (
        pytest.raises(LearningError, match="bob: in training and in test")
        if refused
        else (nullcontext())
    ):
        report = evaluate_postures([], tmp_path / "out", plan, QUIET)
        result = report["recognizers"]["default"]
        assert (result["all"]["correct"], result["all"]["tested"]) == (7, 9), "all but cas's"
        assert report["split"] == f"{model} models"
    assert bool(tracked.given) is not refused


def test_a_model_that_knows_none_of_the_postures_measures_nothing(
    people: list[Recording], tmp_path: Path
) -> None:
    model = tmp_path / "model.npz"
    save(train({"walk_toward": [perform("walk_toward", n) for n in range(3)]}), model)
    with pytest.raises(TrainingError, match="knows none of the postures of these clips"):
        evaluate_postures([], tmp_path, Plan(recognizers=("default",), model=model), QUIET)


def test_a_fault_of_ours_is_not_dressed_as_a_users_mistake(
    people: list[Recording], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def broken(*_: object) -> None:
        raise ValueError("axis 1 is out of bounds for array of dimension 1")

    monkeypatch.setattr(posture_evaluation, "draw_confusion", broken)
    with pytest.raises(ValueError, match="axis 1") as met:
        evaluate(tmp_path, EACH_IN_TURN)
    assert code_of(met.value) == 1


def test_who_is_learnt_from_and_who_is_tested_are_told_apart(
    people: list[Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(posture_evaluation, "spread_of", len)
    told = posture_evaluation._people(people, Plan("ann:bob,cas"))
    assert told == {
        "learnt from": {"performers": ["ann"], "clips": 3, "styles": 3},
        "tested": {"performers": ["bob", "cas"], "clips": 6, "styles": 6},
    }
    everybody = {"tested": {"performers": ["ann", "bob", "cas"], "clips": 9, "styles": 9}}
    assert posture_evaluation._people(people, Plan(EACH_IN_TURN)) == everybody
    model = tmp_path / "model.npz"
    assert posture_evaluation._people(people, Plan("ann:bob", model=model)) == everybody


def test_a_result_says_how_long_learning_took_and_what_each_of_the_test_set_in_turn_gives(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = iter([100.0, 102.351])
    monkeypatch.setattr("time.perf_counter", lambda: next(clock, 999.0))
    monkeypatch.setattr(posture_evaluation, "jobs_of", lambda *given: [given])
    groups = {"headline": ["a"], "within test": ["b"]}
    monkeypatch.setattr(
        posture_evaluation, "judged", lambda jobs, _: {**groups, "within test": ["b", *jobs]}
    )
    monkeypatch.setattr(
        posture_evaluation, "result_of", lambda outcomes, least: {"of": outcomes, "least": least}
    )
    found = posture_evaluation._result(["given"], "paper", None, Plan("a:b"), QUIET)  # type: ignore[list-item]
    assert found == {
        "of": ["a"],
        "least": -3.2,
        "within_test": {"of": ["b", (["given"], "a:b", "paper")], "least": -3.2},
        "learning_s": 2.35,
    }


def test_a_sweep_has_a_row_for_each_number_of_symbols_and_a_column_for_states(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    groups = {
        f"{symbols} symbols, {states} states": (symbols, states)
        for symbols in (16, 32, 64, 128, 256)
        for states in range(3, 9)
    }
    monkeypatch.setattr(posture_evaluation, "sweep_of", lambda given, split: [given, split])
    monkeypatch.setattr(posture_evaluation, "judged", lambda jobs, _: groups)
    monkeypatch.setattr(posture_evaluation, "share", lambda group: group)
    told = posture_evaluation._swept([], Plan("a:b"), QUIET)
    assert list(told["symbols"]) == [16, 32, 64, 128, 256]
    assert list(told["states"]) == [3, 4, 5, 6, 7, 8]
    assert told["shares"] == [
        [(symbols, states) for states in range(3, 9)] for symbols in (16, 32, 64, 128, 256)
    ]
