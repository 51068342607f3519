"""`tritrack evaluate tracking` under a user's hands: one made-up clip from video to report."""

import json
import shutil
import sys
from contextlib import redirect_stdout
from html.parser import HTMLParser
from io import StringIO
from pathlib import Path
from typing import Any, cast

import cv2
import msgspec
import numpy as np
import pytest
from rich.console import Console

import tritrack.__main__ as door
from common.body.body import JOINT_NAMES
from common.config.settings import Settings
from lab.accuracy import accuracy_report, tracking_evaluation
from lab.accuracy.accuracy import compare, summary
from lab.accuracy.silhouette_iou import Overlap
from lab.accuracy.tracking_evaluation import EvaluationError, evaluate_tracking
from lab.accuracy.worst_frames import TRACKED, TRUE
from runtime.offline.batch import Asked
from runtime.offline.lockstep import Tracked
from runtime.store.clip_paths import ClipsFailed
from runtime.store.runs import write_run
from synth.scene.scene_clips import SceneSet, write_scenes

QUIET = Console(quiet=True)
TERMINAL = Console(file=StringIO(), force_terminal=True)
"""Somebody looks on: progress is drawn, of one thing at a time."""


@pytest.fixture(scope="module")
def runs(clip: Path, tracked_clip: Tracked, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("stand")
    settings = Settings(clip=str(clip))
    write_run(out / clip.name, tracked_clip.bodies, settings, tracked_clip.facts)
    return out


@pytest.fixture(scope="module")
def written(clip: Path, runs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a report that the command wrote; what it printed is in `printed.json`."""
    out = tmp_path_factory.mktemp("report")
    words = ["evaluate", "tracking", clip, "--runs", runs, "--out", out, "--json"]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as said:
        patch.setattr(sys, "argv", ["tritrack", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            door.main()
    assert not ended.value.code
    (out / "printed.json").write_text(said.getvalue())
    return out


def report_of(folder: Path) -> dict[str, Any]:
    report: dict[str, Any] = json.loads((folder / "report.json").read_text())
    return report


class Page(HTMLParser):
    """The addresses that a page would fetch, and its texts."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.texts: list[str] = []
        self.feed(path.read_text())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.fetched += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.texts.append(data.strip())


@pytest.mark.slow
def test_the_report_says_what_run_and_truth_say(clip: Path, runs: Path, written: Path) -> None:
    report = report_of(written)
    with np.load(runs / clip.name / "poses.npz") as poses, np.load(clip / "truth.npz") as truth:
        due = summary([compare(poses, truth)])
    assert report["all"] == json.loads(json.dumps(due))
    assert report["per_clip"] == {clip.name: report["all"]}
    assert list(report["per_posture"]) == ["raise_right_lateral"]
    assert list(report["per_performer"]) == ["s90001"]
    assert (report["mode"], report["size"]) == (["default"], ["160x120"])
    assert 0.8 < report["silhouettes"]["mean"] < 1.0
    joints = 12 * due["frames"] * due["coverage"]
    assert sum(one["count"] for one in report["confidence"]["bins"]) == joints
    assert 0.0 < report["lengths"]["body"]["all"]["off_mm"] < 100.0


def test_the_page_needs_nothing_but_the_pictures_beside_it(written: Path) -> None:
    page, report = Page(written / "report.html"), report_of(written)
    assert set(page.fetched) == {path.name for path in written.glob("*.png")}
    assert all(cv2.imread(str(written / name)) is not None for name in page.fetched)
    assert f"{report['all']['abs_mm']['mean']:.1f}" in page.texts
    assert "nan" not in " ".join(page.texts)


def test_the_worst_frames_show_both_cameras_and_both_sticks(written: Path) -> None:
    shown = report_of(written)["worst"]
    assert 3 <= len(shown) <= 10
    picture = cv2.imread(str(written / shown[0]["picture"]))
    assert picture is not None
    assert picture.shape == (480, 1280, 3)
    for half in (picture[:, :640].astype(int), picture[:, 640:].astype(int)):
        for colours in (TRUE, TRACKED):
            drawn = [(np.abs(half - colour).max(axis=2) < 8).sum() for colour in colours]
            assert sum(drawn) > 50  # where sides lie over each other one covers the other


@pytest.mark.slow
def test_a_run_that_stands_is_read_wherever_its_clip_is(
    clip: Path, runs: Path, written: Path, tmp_path: Path
) -> None:
    """Alone a run names its clip; a run whose clip moved is read with the clip that is given."""
    moved = spoilt(clip, runs, tmp_path, "a clip that is gone")
    for paths in ([runs / clip.name], [moved, clip]):
        told = evaluate_tracking(paths, tmp_path / "report", None, None, None, QUIET)
        assert json.loads(json.dumps(told["all"])) == report_of(written)["all"]
    assert not (tmp_path / "report" / "runs").exists()


@pytest.mark.slow
def test_a_clip_without_a_run_is_tracked_as_asked(clip: Path, tmp_path: Path) -> None:
    """What stands in OUT is not taken for the answer: the program may be another now."""
    stale = tmp_path / "runs" / clip.name
    stale.mkdir(parents=True)
    (stale / "poses.npz").write_bytes(b"stale")
    told = evaluate_tracking([clip], tmp_path, None, "paper", None, TERMINAL)
    assert told["mode"] == ["paper"]
    assert (stale / "summary.json").is_file()


def copied_run(clip: Path, runs: Path, out: Path) -> Path:
    return Path(shutil.copytree(runs / clip.name, out / clip.name))


def spoilt(clip: Path, runs: Path, out: Path, what: str) -> Path:
    """A copy of a run, or of its clip, with something wrong."""
    run = copied_run(clip, runs, out)
    if what == "no summary":
        (run / "summary.json").unlink()
    elif what == "a damaged run":
        (run / "poses.npz").write_bytes(b"PK\3\4")
    elif what == "a clip that is gone":
        facts = json.loads((run / "summary.json").read_text())
        facts["settings"]["clip"] = "gone"
        (run / "summary.json").write_text(json.dumps(facts))
    elif what == "a run of other joints":
        with np.load(run / "poses.npz") as poses:
            held = {name: poses[name] for name in poses.files}
        np.savez(run / "poses.npz", **{**held, "joint_names": held["joint_names"][::-1][:3]})
    else:
        with np.load(run / "poses.npz") as poses:
            held = {name: poses[name] for name in poses.files if name != "confidence"}
        np.savez(run / "poses.npz", **held)
    return run


@pytest.mark.parametrize(
    ("what", "reason"),
    [
        ("no summary", "is no run folder: .*summary.json.*; track the clip again"),
        ("a damaged run", "cannot read .*poses.npz: .*; make it again"),
        ("a clip that is gone", "needs gone/truth.npz, which is not there: name its clip"),
        ("a run of other joints", "do not fit together: there is no joint 'l_shoulder'"),
        ("no confidence", "poses.npz has no confidence: make it again"),
    ],
)
def test_a_run_that_cannot_be_scored_is_named(
    clip: Path, runs: Path, tmp_path: Path, what: str, reason: str
) -> None:
    run = spoilt(clip, runs, tmp_path, what)
    with pytest.raises(EvaluationError, match=reason):
        evaluate_tracking([run], tmp_path / "report", None, None, None, QUIET)


def test_a_run_of_another_mode_is_not_taken_for_what_was_asked(
    clip: Path, runs: Path, tmp_path: Path
) -> None:
    with pytest.raises(EvaluationError, match="tracked with mode default, not paper"):
        evaluate_tracking([clip], tmp_path, runs, "paper", None, QUIET)
    with pytest.raises(EvaluationError, match="tracked with size 160x120, not 80x60"):
        evaluate_tracking([clip], tmp_path, runs, None, "80x60", QUIET)


def test_a_clip_without_truth_is_nothing_to_score(clip: Path, runs: Path, tmp_path: Path) -> None:
    bare = tmp_path / clip.name
    bare.mkdir()
    with pytest.raises(EvaluationError, match="no clip has both a truth"):
        evaluate_tracking([bare], tmp_path / "report", runs, None, None, QUIET)


def test_a_report_that_cannot_be_written_is_said(clip: Path, runs: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(EvaluationError, match=r"cannot write into .*file: .*; name another --out"):
        evaluate_tracking([clip], tmp_path / "file", runs, None, None, QUIET)


def test_two_clips_of_one_name_are_not_mixed(clip: Path, tmp_path: Path) -> None:
    other = tmp_path / clip.name
    other.mkdir()
    with pytest.raises(ClipsFailed, match="would both be written to"):
        evaluate_tracking([clip, other], tmp_path / "report", None, None, None, QUIET)


def test_the_command_prints_the_headline(written: Path) -> None:
    told, report = json.loads((written / "printed.json").read_text()), report_of(written)
    assert told["abs_mm"] == report["all"]["abs_mm"]
    assert told["confidence_auc"] == report["confidence"]["auc"]["all"]
    assert told["silhouettes_iou"] == report["silhouettes"]["mean"]


def case_of(performer: str, posture: str = "squat") -> Any:
    settings = Settings(mode="default", size="80x60")
    return tracking_evaluation.Case(settings, performer, posture, None, cast(Any, performer), {})


def test_silhouettes_are_meant_over_views_then_clips_then_performers() -> None:
    """Two clips of ann, one of bob, one without masks; of 8 empty frames 2 got a silhouette."""
    cases = {
        name: case_of(who) for name, who in zip("cabd", ("ann", "ann", "bob", "eve"), strict=True)
    }
    found = {
        "c": {
            "cam1": Overlap(np.array([0.5, 0.7]), 3, 1),
            "cam2": Overlap(np.array([0.8]), 1, 0),
        },
        "a": {"cam2": Overlap(np.array([0.9]), 2, 1)},
        "b": {"cam1": Overlap(np.array([0.4, 0.2, 0.6]), 2, 0)},
        "d": {},
    }
    told = tracking_evaluation._silhouettes(cases, found)
    assert told["per_clip"] == {
        "c": pytest.approx({"cam1": 0.6, "cam2": 0.8, "both": 0.7}),
        "a": pytest.approx({"cam2": 0.9, "both": 0.9}),
        "b": pytest.approx({"cam1": 0.4, "both": 0.4}),
    }
    assert told["per_performer"] == pytest.approx({"ann": 0.8, "bob": 0.4})
    assert list(told["per_performer"]) == ["ann", "bob"]
    assert (told["mean"], told["worst"]) == pytest.approx((2 / 3, 0.4))
    assert told["ghost"] == pytest.approx(2 / 8)


def test_silhouettes_of_clips_without_masks_or_without_empty_frames_have_no_figure() -> None:
    told = tracking_evaluation._silhouettes({"d": case_of("eve")}, {"d": {}})
    assert np.isnan([told["mean"], told["worst"], told["ghost"]]).all()
    full = {"d": {"cam1": Overlap(np.array([0.4]), 0, 0)}}
    told = tracking_evaluation._silhouettes({"d": case_of("eve")}, full)
    assert np.isnan(told["ghost"])
    assert told["mean"] == 0.4


def test_clips_are_grouped_by_what_is_asked_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tracking_evaluation, "summary", lambda group: {"of": group})
    cases = {"x": case_of("bob"), "y": case_of("ann", "kick"), "z": case_of("bob", "kick")}
    told = tracking_evaluation._grouped(cases, lambda one: one.performer)
    assert list(told.items()) == [("ann", {"of": ["ann"]}), ("bob", {"of": ["bob", "bob"]})]
    told = tracking_evaluation._grouped(cases, lambda one: one.posture)
    assert list(told) == ["kick", "squat"]


def folder(path: Path, *files: str) -> Path:
    path.mkdir(parents=True)
    for name in files:
        (path / name).write_text("")
    return path


def test_runs_that_stand_are_read_and_clips_that_have_none_are_tracked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted: list[Any] = []
    monkeypatch.setattr(tracking_evaluation, "track_all", lambda *given: noted.append(given))
    clips = [folder(tmp_path / "clips" / name, "truth.npz") for name in "abc"]
    bare = folder(tmp_path / "clips" / "bare")
    alone = folder(tmp_path / "elsewhere" / "d", "poses.npz")
    given = folder(tmp_path / "elsewhere" / "b", "poses.npz")
    runs = tmp_path / "runs"
    for name in "ab":
        folder(runs / name, "poses.npz")
    console = Console(file=StringIO(), width=400)
    paths = [clips[2], bare, clips[0], given, alone, clips[1]]
    found = tracking_evaluation._runs_of(paths, tmp_path / "out", runs, "paper", "80x60", console)
    assert list(found.items()) == [
        ("a", (runs / "a", clips[0])),
        ("b", (given, clips[1])),
        ("c", (runs / "c", clips[2])),
        ("d", (alone, None)),
    ]
    assert noted == [([clips[2]], runs, Asked("paper", "80x60", force=True), console)]
    assert f"{bare} has no truth.npz: left out" in cast(StringIO, console.file).getvalue()
    noted.clear()
    fresh = tracking_evaluation._runs_of(clips, tmp_path / "out", None, None, None, console)
    assert [run for run, _ in fresh.values()] == [tmp_path / "out" / "runs" / n for n in "abc"]
    assert noted == [(clips, tmp_path / "out" / "runs", Asked(None, None, force=True), console)]
    noted.clear()
    tracking_evaluation._runs_of([given], tmp_path / "out", None, None, None, console)
    assert not noted


@pytest.mark.slow
def test_several_people_are_scored_one_by_one_and_by_who_is_who(tmp_path: Path) -> None:
    """A made-up scene, and a run that knows the truth but exchanges two numbers half-way."""
    (scene,) = write_scenes(tmp_path / "clips", SceneSet(2, 3.0, 1, 11), (64, 48))
    with np.load(scene / "truth.npz") as truth:
        held = {name: truth[name] for name in truth.files}
    picked = [held["joint_names"].tolist().index(name) for name in JOINT_NAMES]
    there = held["present"]
    later = (held["frame"] > 26) & there
    number = np.where(later, 1 - held["person"], held["person"])[there]
    run = tmp_path / "runs" / scene.name
    run.mkdir(parents=True)
    order = np.lexsort([number, held["frame"][there]])
    np.savez(
        run / "poses.npz",
        frame=held["frame"][there][order],
        person=number[order],
        joints_m=held["joints3d"][there][:, picked][order],
        joint_names=np.array(JOINT_NAMES),
        confidence=np.ones((int(there.sum()), len(JOINT_NAMES))),
    )
    settings = msgspec.to_builtins(Settings(clip=str(scene)))
    (run / "summary.json").write_text(json.dumps({"settings": settings, "bdp_m": None}))
    told = evaluate_tracking([scene], tmp_path / "report", tmp_path / "runs", None, None, QUIET)
    of_all = told["identities"]["all"]
    assert (of_all["switches"], of_all["misses"], of_all["false"]) == (2, 0, 0)
    own = max(later.sum(), (there & ~later).sum())
    assert of_all["idf1"] == pytest.approx(own / there.sum())
    assert of_all["matched_mm"] < 0.01
    assert list(told["per_clip"]) == [f"{scene.name}, person {who}" for who in (0, 1)]
    assert all(0.0 < one["lost"] < 0.6 for one in told["per_clip"].values())
    page = Page(tmp_path / "report" / "report.html")
    assert f"{of_all['idf1']:.3f}" in page.texts
    line = accuracy_report.line(told)
    assert f"IDF1 {of_all['idf1']:.3f}, AssA {of_all['assa']:.3f}" in line
    assert line.endswith("2 switches")
    assert accuracy_report.headline(told)["identities"] == of_all
