"""What is typed for recorded clips reaches what does the work; what that gives is said."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typed import instead, typed

from common.config.part_settings import BusSettings, SettingsError
from common.config.settings import Settings
from runtime.faults import Unfollowed
from synth.scene.scene_clips import SceneSet
from synth.write import ClipSet
from tritrack.commands.clip_commands import (
    line_of_runs,
    replay,
    retouch,
    single,
    synth,
    track,
)
from tritrack.commands.export_command import export

FACTS = {"clips": {"dance": {"believed": 0.9, "followed": 0.9, "frames": 30, "seen": 30}}}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_all_that_is_typed_for_tracking_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    done = instead(monkeypatch, "runtime.offline.batch.track_all", FACTS)
    refused = instead(monkeypatch, "tritrack.commands.clip_commands.refuse_unfollowed")
    words = ["a", "b", "--out", "new", "--mode", "thesis", "--views", "2", "--size", "160x120"]
    words += ["--landmarks", "none", "--trust-calibration", "--record", "--resume", "--force"]
    said = typed(track, *words)
    clips, out, asked, _ = done.last
    assert (clips, out) == ([Path("a"), Path("b")], Path("new"))
    assert (asked.mode, asked.size, asked.landmarks, asked.views) == (
        *("thesis", "160x120", "none"),
        (2,),
    )
    assert asked.trusted is asked.record is asked.resume is asked.force is True
    assert "1 clip tracked, written to new; believed in 90% of the frames" in said.output
    assert refused.last == (FACTS["clips"],)
    typed(track, "a")
    clips, out, asked, _ = done.last
    assert (out, asked.mode, asked.size, asked.landmarks) == (Path("runs"), None, None, None)
    assert asked.views is None
    assert asked.trusted is asked.record is asked.resume is asked.force is False
    assert json.loads(typed(track, "a", "--json").stdout) == FACTS
    assert typed(track, "a", "--views", "1").exit_code == 0
    assert done.last[2].views == (1,)


def test_a_body_that_is_hardly_followed_is_no_success(monkeypatch: pytest.MonkeyPatch) -> None:
    facts = {"clips": {"dance": {"believed": 0.1, "followed": 0.1, "warnings": []}}}
    instead(monkeypatch, "runtime.offline.batch.track_all", facts)
    instead(monkeypatch, "tritrack.single.single.single_all", facts)
    for command in (track, single):
        with pytest.raises(Unfollowed):
            typed(command, "a")


def test_the_line_of_runs_averages_what_is_believed_and_names_rigs_that_are_not() -> None:
    clips: dict[str, dict[str, Any]] = {
        "a": {"believed": 0.5},
        "b": {"believed": 1.0, "trust": {"advice": "turn it"}},
        "c": {"believed": None, "trust": None},
    }
    line = line_of_runs(clips, Path("runs"))
    assert line.startswith("3 clips tracked, written to runs; believed in 75% of the frames")
    assert line.endswith("not believable: the calibration of b, see the warning above")
    assert line_of_runs({"c": clips["c"]}, Path("x")) == "1 clip tracked, written to x"


def test_people_are_made_as_many_and_as_they_are_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = instead(monkeypatch, "tritrack.making.make_clips", [Path("x/a"), Path("x/b")])
    words = ["--motion", "postures", "--performers", 3, "--takes", 2, "--seed", 7]
    said = typed(
        synth, "--out", "x", *words, "--size", "160x120", "--posture", "squat", "--cameras", 3
    )
    assert made.last[:3] == (Path("x"), ClipSet("postures", 3, 2, 7, ("squat",), 3), "160x120")
    assert "2 clips written to x" in said.output
    said = typed(synth, "--out", "x", "--json")
    assert made.last[1:3] == (ClipSet("postures", 1, 1, 0, (), 2), "320x240")
    assert json.loads(said.stdout) == {"clips": ["x/a", "x/b"]}


def test_scenes_are_made_as_they_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    made = instead(monkeypatch, "tritrack.making.make_clips", [Path("x/a")])
    words = ["--people", 2, "--seconds", 8, "--cameras", 3, "--takes", 4, "--seed", 7]
    typed(synth, "--out", "x", *words, "--no-opening", "--alone")
    wanted = SceneSet(2, 8.0, 4, 7, 3, opening=False, alone=True)
    assert made.last[:3] == (Path("x"), wanted, "320x240")
    typed(synth, "--out", "x", "--people", 1, "--seconds", 0)
    assert made.last[1].lasts_s == 0.0, "refused later, not taken for none"
    typed(synth, "--out", "x", "--people", 1)
    assert made.last[1] == SceneSet(1, 10.0, 1, 0, 2, opening=True)
    typed(synth, "--out", "x", "--people", 2, "--posture", "squat", "--posture", "kick_left_side")
    assert made.last[1] == SceneSet(2, postures=("squat", "kick_left_side"))


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--people", 2, "--motion", "free"], "--motion is of clips of one person: leave it or"),
        (["--people", 2, "--performers", 2], "--performers is of clips of one person"),
        (["--seconds", 9], "--seconds needs --people: other clips have their own"),
        (["--alone"], "--alone needs --people: other clips have their own"),
        (["--no-opening"], "--no-opening needs --people: other clips have their own"),
    ],
)
def test_what_does_not_go_with_scenes_is_refused(words: list[Any], reason: str) -> None:
    with pytest.raises(SettingsError, match=reason):
        typed(synth, "--out", "x", *words)


def test_all_that_is_typed_for_one_camera_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    done = instead(monkeypatch, "tritrack.single.single.single_all", FACTS)
    instead(monkeypatch, "tritrack.commands.clip_commands.refuse_unfollowed")
    words = ["--notes", "n.toml", "--mode", "thesis", "--size", "160x120", "--landmarks", "none"]
    words += ["--background", "room.png", "--resume", "--force", "--json", "--out", "new"]
    said = typed(single, "a.mp4", *words)
    videos, out, given, settings, _ = done.last
    assert (videos, out) == ([Path("a.mp4")], Path("new"))
    assert given == (Path("n.toml"), Path("room.png"), True, True, "none")
    assert (settings.mode, settings.size) == ("thesis", "160x120")
    assert json.loads(said.stdout) == FACTS
    said = typed(single, "a.mp4")
    assert done.last[2] == (None, None, False, False, None)
    assert (done.last[3].mode, done.last[3].size) == ("default", "320x240")
    assert said.stdout == ""


def test_a_run_is_exported_as_it_is_typed_and_how_far_bones_are_off_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    facts = {"frames": 5, "file": "x.bvh"}
    done = instead(monkeypatch, "tritrack.commands.export_command.export_run", facts)
    said = typed(export, "run", "--to", "bvh", "--out", "x.bvh", "--scale", "cm", "--force")
    assert done.last == (Path("run"), "bvh", Path("x.bvh"), "cm", True, None)
    assert "5 frames written to x.bvh" in said.output
    assert "mm off" not in said.output
    done.answer = {**facts, "off_mm": {"median": 1.5, "p95": 4.0}}
    said = typed(export, "run", "--to", "gltf", "--person", 2)
    assert done.last == (Path("run"), "gltf", None, "m", False, 2)
    assert "fixed bones: 1.5 mm off, 95 % within 4.0 mm" in said.output


def test_an_export_of_several_people_says_a_line_of_each(monkeypatch: pytest.MonkeyPatch) -> None:
    people = [
        {"person": 1, "frames": 5, "file": "a_person1.trc", "empty": 2},
        {"person": 4, "frames": 1, "file": "a_person4.trc", "empty": 0},
    ]
    facts = {"frames": 6, "people": people, "left_out": {3: "1 frames have a pose"}}
    instead(monkeypatch, "tritrack.commands.export_command.export_run", facts)
    said = typed(export, "run", "--to", "trc").output.splitlines()
    assert said[0].startswith("5 frames written to a_person1.trc; 2 without a pose are empty")
    assert said[1:] == [
        "1 frame written to a_person4.trc",
        "person 3 is left out: 1 frames have a pose",
    ]


def test_a_recording_is_integrated_said_on_a_bus_or_played_on_a_page(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = instead(monkeypatch, "tritrack.replaying.replay_run", {"bodies": 1, "same": 1})
    bus = instead(monkeypatch, "tritrack.replaying.replay_on_bus", {"said": 4})
    page = instead(monkeypatch, "tritrack.replay_page.replay_on_page", {"shown": 9})
    said = typed(replay, "run", "--out", "new", "--force")
    assert run.last == (Path("run"), Path("new"), True)
    assert "1 body, 1 of them the same byte for byte; written to new" in said.output
    assert "written" not in typed(replay, "run").output
    assert run.last == (Path("run"), None, False)
    said = typed(replay, "run", "--bus", "tls/127.0.0.1:7", "--speed", 2.5, "--keys", "k")
    settings = BusSettings(endpoint="tls/127.0.0.1:7", keys="k")
    assert bus.last[:3] == (Path("run"), settings, 2.5)
    assert "4 messages said" in said.output
    said = typed(replay, "run", "--page", "--port", 9000)
    assert page.last[:2] == (Path("run"), 9000)
    assert "9 frames shown" in said.output
    assert len(run.given) == 2


def test_a_run_is_retouched_with_its_video_and_notes(monkeypatch: pytest.MonkeyPatch) -> None:
    done = instead(monkeypatch, "tritrack.single.retouching.retouch", {"notes": "n"})
    instead(monkeypatch, "tritrack.single.ledger.line_of", "three inputs")
    said = typed(retouch, "run", "--video", "v.mp4", "--notes", "n.toml", "--port", 9000)
    assert done.last[:4] == (Path("run"), Path("v.mp4"), Path("n.toml"), 9000)
    assert "three inputs" in said.output
    typed(retouch, "run")
    assert done.last[:4] == (Path("run"), None, None, 8080)
    assert Settings().page.port == 8080, "the same page as a live run's"


def test_loading_a_command_collects_garbage_hardly_ever() -> None:
    """What is loaded stays: Python's own thresholds would look through it some 200 times."""
    code = (
        "import gc, tritrack.__main__, runtime.offline.batch; "
        "print(sum(each['collections'] for each in gc.get_stats()))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(run.stdout) < 60
