"""What is typed for models and figures reaches what learns and measures."""

from pathlib import Path
from typing import Any

import pytest
from typed import instead, typed

from common.atomic_file import FileRefused
from common.config.settings import Settings
from lab.landmark_lessons import work_of
from lab.postures.posture_evaluation import KINDS
from lab.postures.posture_evaluation import Plan as Split
from lab.training.training import Plan
from tritrack.commands import model_commands
from tritrack.commands.model_commands import evaluate_app, teach, train
from tritrack.commands.options import CACHE


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(model_commands, "refuse_without", lambda *_: None)
    return tmp_path


def test_postures_are_learnt_of_the_clips_that_are_typed(monkeypatch: pytest.MonkeyPatch) -> None:
    facts = {"sequences": {"squat": 3}, "knows": ["squat", "bow"]}
    done = instead(monkeypatch, "lab.training.training.train_postures", facts)
    words = ["--recognizer", "paper", "--mode", "default", "--cache", "kept"]
    said = typed(train, "a", "b", "--out", "m.npz", *words)
    assert done.last[:3] == (
        [Path("a"), Path("b")],
        Path("m.npz"),
        Plan("default", "paper", Path("kept")),
    )
    assert "1 posture learnt, 2 known; written to m.npz" in said.output
    typed(train, "a", "--out", "m.npz")
    assert done.last[2] == Plan(None, "default", CACHE)
    said = typed(train, "--out", "m.npz")
    assert (said.exit_code, "name clips or run folders" in said.output) == (2, True)


@pytest.mark.parametrize(
    ("what", "place", "counted"),
    [
        ("proposals", "lab.training.proposal_training.train_proposals", "instants"),
        ("lifting", "lab.training.lifting_training.train_lifting", "instants"),
        ("silhouettes", "lab.training.silhouette_training.train_silhouettes", "pixels"),
    ],
)
def test_each_network_is_learnt_by_its_own_teacher(
    monkeypatch: pytest.MonkeyPatch, what: str, place: str, counted: str
) -> None:
    done = instead(monkeypatch, place, {counted: 77})
    said = typed(train, "--what", what, "--out", "n.npz")
    assert done.last[:2] == (Path("n.npz"), 0)
    assert f"77 {counted} learnt, written to n.npz" in said.output


def test_a_model_is_replaced_only_by_force_and_landmarks_go_on_where_they_were(
    monkeypatch: pytest.MonkeyPatch, here: Path
) -> None:
    (here / "m.npz").write_text("mine")
    taught = instead(monkeypatch, "tritrack.commands.model_commands._teach_on_videos")
    with pytest.raises(FileRefused):
        typed(train, "a", "--out", "m.npz")
    with pytest.raises(FileRefused):
        typed(train, "--what", "landmarks", "--film", "f.mp4", "--out", "m.npz")
    work_of(here / "m.npz").mkdir()
    with pytest.raises(FileRefused):
        typed(train, "a", "--out", "m.npz")
    words = ["--film", "f.mp4", "--film", "g.mp4", "--teacher", "keys"]
    typed(train, "--what", "landmarks", *words, "--out", here / "m.npz", "--json")
    assert taught.last == ([Path("f.mp4"), Path("g.mp4")], "keys", here / "m.npz", True)
    said = typed(train, "--film", "f.mp4", "--out", "new.npz")
    assert (said.exit_code, "only landmarks are learnt from videos" in said.output) == (2, True)


def test_a_posture_is_taught_by_takes_or_before_cameras_not_by_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from lab.training import teaching

    monkeypatch.setattr(teaching, "line", lambda facts: f"taught: {facts['n']}")
    films = instead(monkeypatch, "lab.training.teaching.teach", {"n": 1})
    live = instead(monkeypatch, "lab.training.live_teaching.teach_live", {"n": 2})
    settings = Settings(mode="paper")
    instead(monkeypatch, "tritrack.commands.model_commands.config_file.load", settings)
    words = ["--out", "m.npz", "--add-to", "old.npz", "--again", "--recognizer", "paper"]
    said = typed(teach, "jump", "a", "b", *words, "--cache", "kept")
    plan = Plan(None, "paper", Path("kept"), Path("old.npz"), True)
    assert films.last[:4] == ("jump", [Path("a"), Path("b")], Path("m.npz"), plan)
    assert "taught: 1" in said.output
    said = typed(teach, "jump", "--live", "cams.toml", "--count-in", 5, "--out", "m.npz")
    posture, given, out, plan, _, count_s = live.last
    assert (posture, given, out, count_s) == ("jump", settings, Path("m.npz"), 5.0)
    assert plan == Plan(None, "default", CACHE, Path("shipped"), False)
    assert "taught: 2" in said.output
    for words in (["jump"], ["jump", "a", "--live", "cams.toml"]):
        said = typed(teach, *words, "--out", "m.npz")
        assert (said.exit_code, "name takes of it, or --live CONFIG" in said.output) == (2, True)


def test_what_is_evaluated_is_what_is_typed(monkeypatch: pytest.MonkeyPatch) -> None:
    report: dict[str, Any] = {"recognizers": {"default": {"table": "A"}, "paper": {"table": "B"}}}
    place = "lab.postures.posture_evaluation.evaluate_postures"
    done = instead(monkeypatch, place, report)
    words = ["--split", "a:b", "--recognizer", "paper", "--mode", "default", "--model", "m.npz"]
    words += ["--sweep", "--cache", "kept", "--dask", "tcp://h:1"]
    said = typed(evaluate_app, "postures", "x", "y", "--out", "r", *words)
    plan = Split("a:b", KINDS["paper"], "default", Path("m.npz"), True, Path("kept"), "tcp://h:1")
    assert done.last[:3] == ([Path("x"), Path("y")], Path("r"), plan)
    assert "default recogniser:\nA\n\npaper recogniser:\nB" in said.output
    typed(evaluate_app, "postures", "x", "--out", "r")
    assert done.last[2] == Split(cache=CACHE)


def test_spotting_and_tracking_are_measured_as_they_are_typed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    place = "lab.postures.spotting_report.evaluate_spotting"
    spotted = instead(monkeypatch, place, {"table": "two of three"})
    words = ["--model", "m.npz", "--mode", "paper"]
    said = typed(evaluate_app, "spotting", "x", "--out", "r", *words)
    assert spotted.last[:4] == ([Path("x")], Path("r"), Path("m.npz"), "paper")
    assert "two of three" in said.output
    place = "lab.accuracy.tracking_evaluation.evaluate_tracking"
    tracked = instead(monkeypatch, place, {"n": 1})
    instead(monkeypatch, "lab.accuracy.accuracy_report.headline", {"mm": 20})
    instead(monkeypatch, "lab.accuracy.accuracy_report.line", "20 mm")
    words = ["--runs", "runs", "--mode", "paper", "--size", "160x120"]
    said = typed(evaluate_app, "tracking", "x", "--out", "r", *words)
    assert tracked.last[:5] == ([Path("x")], Path("r"), Path("runs"), "paper", "160x120")
    assert "20 mm; written to r" in said.output


LEARN = ("learn", "sklearn")
REPORT = ("report", "matplotlib")


@pytest.mark.parametrize(
    ("command", "words", "needs"),
    [
        (train, ("a",), [LEARN]),
        (train, ("--what", "silhouettes"), [LEARN]),
        (train, ("--what", "landmarks"), [("train", "torch", "onnx", "onnxscript", "anny")]),
        (teach, ("jump", "a"), [LEARN]),
        (evaluate_app, ("postures", "a"), [REPORT, LEARN]),
        (evaluate_app, ("postures", "a", "--model", "m.npz"), [REPORT]),
        (evaluate_app, ("tracking", "a"), [REPORT]),
    ],
)
def test_what_a_command_lacks_is_said_before_it_begins(
    monkeypatch: pytest.MonkeyPatch, command: Any, words: tuple[str, ...], needs: list[Any]
) -> None:
    """The last thing that is asked for is missing: the work is never begun."""

    class Lacking(Exception):
        """It is not there."""

    asked: list[tuple[str, ...]] = []

    def refuse(*given: str) -> None:
        asked.append(given)
        if len(asked) == len(needs):
            raise Lacking

    monkeypatch.setattr(model_commands, "refuse_without", refuse)
    with pytest.raises(Lacking):
        typed(command, *words, "--out", "m.npz")
    assert asked == needs
