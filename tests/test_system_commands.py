"""The commands under a user's hands: wrong words, wrong files, full disks."""

import importlib
import json
import os
import re
import resource
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pytest
import typer
from spoiling import REFUSED, WORKED_WITH, copied, cut_off, damage, edit_json, refilmed

import tritrack.__main__ as door
from calibration.foreign.toml_rig import toml_text
from common.config.settings import Settings
from common.rig.camera import paper_rig
from common.rig.rig_file import load_rig
from runtime.live import session
from runtime.offline import batch
from runtime.offline.lockstep import Tracked, track_clip
from runtime.store.other_run import run_of
from runtime.store.past_run import open_run
from runtime.store.runs import write_run


class Ended(NamedTuple):
    """How a command ended and what it said."""

    code: int
    out: str
    err: str

    @property
    def errors(self) -> list[str]:
        return [line for line in self.err.splitlines() if line.startswith("error: ")]

    @property
    def warnings(self) -> list[str]:
        return [line for line in self.err.splitlines() if line.startswith("warning: ")]


COMMANDS_OF = cache(typer.main.get_command)
"""Read once from the signatures of all commands, and not for each that is run."""


class Commands:
    """Runs commands in this process as the shell would."""

    def __init__(self, patch: pytest.MonkeyPatch, capture: pytest.CaptureFixture[str]) -> None:
        self._patch, self._capture = patch, capture
        patch.setattr(typer.main, "get_command", COMMANDS_OF)

    def __call__(self, *words: str | Path) -> Ended:
        self._patch.setattr(sys, "argv", ["tritrack", *map(str, words)])
        self._capture.readouterr()
        with pytest.raises(SystemExit) as ended:
            door.main()
        said = self._capture.readouterr()
        return Ended(int(ended.value.code or 0), said.out, said.err)


OF_THE_PERSON = ("no calibration", "other size")
"""Of `WORKED_WITH` those whose cameras are calibrated by their person."""
MOST_LETTERS = 55
"""Of a command's first sentence: more are cut where commands are listed."""


@pytest.fixture
def tritrack(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Commands:
    return Commands(monkeypatch, capsys)


@pytest.fixture
def no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fail if a live run gets so far as to start processes."""

    def started(*_: object) -> None:
        raise AssertionError("a process was started")

    monkeypatch.setattr(session, "run", started)


@pytest.fixture
def as_tracked(monkeypatch: pytest.MonkeyPatch, tracked_clip: Tracked) -> list[Settings]:
    """Every clip that is tracked gives what was made of `clip`; the settings that each was asked
    for."""
    asked: list[Settings] = []

    def track(settings: Settings, *_: object, **__: object) -> Tracked:
        asked.append(settings)
        return tracked_clip

    monkeypatch.setattr(batch, "track_clip", track)
    return asked


def every_command() -> list[list[str]]:
    group = typer.main.get_command(door.app)
    words: list[list[str]] = []
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        inner = getattr(command, "commands", None)
        words += [[name, each] for each in inner] if inner else [[name]]
    return words


def toml(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


@pytest.mark.parametrize("words", every_command(), ids=" ".join)
def test_every_command_has_help_with_an_example(tritrack: Commands, words: list[str]) -> None:
    said = tritrack(*words, "--help")
    assert said.code == 0
    assert f"Example: tritrack {' '.join(words)}" in " ".join(said.out.split())


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["zzz"], "No such command 'zzz'; see: "),
        (["trak"], "Did you mean 'track'"),
        (["track"], "Missing argument 'clips'; see: "),
        (
            ["track", "--views", "left", "x"],
            "cameras are numbers with commas between: 2 or 1,3; got left",
        ),
        (["track", "--nosuch", "x"], "No such option"),
        (["--log-level", "loud", "doctor"], "'loud' is not one of"),
        (
            ["track", "nosuch"],
            "no clip folder and no settings file nosuch: check",
        ),
        (["live", "nosuch.toml"], "there is no clip folder and no settings file nosuch.toml"),
        (["live"], "Missing argument"),
        (["view", "x", "--viewer", "9"], "--viewer"),
        (["synth"], "Missing option '--out'"),
        (["synth", "--out", "o", "--performers", "0"], "--performers"),
        (["synth", "--out", "o", "--takes", "0"], "--takes"),
        (["synth", "--out", "o", "--seed", "-1"], "--seed"),
        (
            ["synth", "--out", "o", "--size", "1x1"],
            "must be from 32x32 to 4096x4096 pixels, got 1x1",
        ),
        (["synth", "--out", "o", "--size", "big"], "size must look like 160x120, got 'big'"),
        (["synth", "--out", "o", "--posture", "dance"], "unknown posture 'dance'; known are walk"),
        (
            ["synth", "--out", "o", "--motion", "free", "--posture", "squat"],
            "no posture belongs to this motion",
        ),
        (["synth", "--out", "/dev/null/o"], "cannot write /dev/null/o: Not a directory"),
        (["track", "x", "--out", "/dev/null/o"], "cannot write /dev/null/o: Not a directory"),
        (["train", "x", "--out", "."], ". is a folder: name a file"),
        (["export", "x", "--to", "csv", "--out", "/dev/null/o"], "Not a directory: /dev/null"),
        (["view", ".", "--viewer", "1"], "has neither cam1.* nor cam2.*: name the videos so"),
        (
            ["train", "nosuch", "--out", "m.npz"],
            "there is no clip folder and no settings file nosuch",
        ),
        (["synth", "--out", "o", "--takes", "500"], "it must be at most 100; see: "),
        (["track", "x", "y", "--size", "abc"], "size must look like 160x120, got 'abc'; see: "),
        (["calibrate", "person", "x", "--stature", "175"], "0.5 to 2.6 metres, got 175: 1.75?; "),
        (["calibrate", "person", "x", "--fov", "200"], "from 10 to 150 degrees, got 200; see: "),
        (["replay", "nosuch"], "there is no run folder nosuch: name one made with --record"),
        (["evaluate", "tracking", "x", "--out", "/proc/x"], "cannot write /proc/x"),
        (["calibrate", "markers", "nosuch"], "cannot read the points nosuch"),
        (["calibrate", "poles", "nosuch"], "cannot read the points nosuch"),
    ],
    ids=lambda given: " ".join(given) if isinstance(given, list) else "",
)
def test_a_users_mistake_is_one_line_and_exit_code_2(
    tritrack: Commands,
    words: list[str],
    error: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    said = tritrack(*words)
    assert (said.code, said.out) == (2, "")
    assert error in said.errors[0]
    assert "Traceback" not in said.err
    assert list(tmp_path.iterdir()) in ([], [tmp_path / "runs"])


@pytest.mark.parametrize("words", every_command(), ids=" ".join)
def test_a_list_of_commands_shows_the_whole_first_sentence(words: list[str]) -> None:
    command = typer.main.get_command(door.app)
    for word in words:
        command = command.commands[word]  # type: ignore[attr-defined]
        first, dot, _ = (command.help or "").partition(".")
        assert dot or command.help == first
        assert len(first) <= MOST_LETTERS
        assert command.get_short_help_str(MOST_LETTERS + 5).rstrip(".") == first


def test_the_help_says_where_to_start_and_that_one_camera_will_do(tritrack: Commands) -> None:
    said = " ".join(tritrack("--help").out.split())
    assert "from two ordinary cameras, or one, in real time" in said
    assert said.endswith(
        "Start: doctor, demo, single, track, live; or tritrack alone, which opens a page."
    )


@pytest.mark.parametrize("words", [["board"], ["markers"], ["poles"]], ids=" ".join)
def test_examples_stand_apart(tritrack: Commands, words: list[str]) -> None:
    said = tritrack("calibrate", *words, "--help").out
    assert said.count("\n\n  Example: tritrack") == 2


def test_the_only_clip_is_refused_in_one_line(tritrack: Commands, tmp_path: Path) -> None:
    one = tritrack("track", tmp_path / "a", "--out", tmp_path / "runs")
    assert (one.code, len(one.errors)) == (2, 1)
    two = tritrack("track", tmp_path / "a", tmp_path / "b", "--out", tmp_path / "runs")
    assert (two.code, len(two.errors)) == (2, 3)
    assert "2 of 2 clips could not be tracked" in two.errors[2]


def test_the_version_is_told(tritrack: Commands) -> None:
    said = tritrack("--version")
    assert (said.code, said.out, said.err) == (0, f"tritrack {version('tritrack')}\n", "")


@pytest.mark.parametrize("words", [[], ["calibrate"]], ids=["tritrack", "calibrate"])
def test_a_command_without_words_shows_its_help(tritrack: Commands, words: list[str]) -> None:
    said = tritrack(*words)
    assert said.code == 2
    assert said.err.startswith("Usage: ")


def test_a_fault_of_the_program_is_one_line_that_names_its_traceback(
    tritrack: Commands, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Only what our own classes say is meant for a user; a bug must be seen as one."""

    empty: list[object] = []

    def broken() -> object:
        return empty[1]

    monkeypatch.setattr(importlib.import_module("tritrack.doctor.installation"), "examine", broken)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    said = tritrack("doctor")
    (kept,) = tmp_path.iterdir()
    fault = "a fault of tritrack itself (IndexError: list index out of range)"
    assert (said.code, said.out) == (1, "")
    assert said.err == f"error: {fault}: please report {kept}\n"
    assert "return empty[1]" in kept.read_text()


def test_ctrl_c_in_the_middle_is_one_line(
    tritrack: Commands, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(
        importlib.import_module("tritrack.doctor.installation"), "examine", interrupted
    )
    said = tritrack("doctor")
    assert (said.code, said.errors) == (130, ["error: stopped before it was done"])


@pytest.mark.parametrize("command", ["track", "live"])
@pytest.mark.parametrize("how", REFUSED)
def test_what_contradicts_itself_or_cannot_be_read_is_refused(
    tritrack: Commands, no_process: None, clip: Path, tmp_path: Path, command: str, how: str
) -> None:
    spoil, error = REFUSED[how]
    spoil(copied(clip, tmp_path / "clip"))
    said = tritrack(command, tmp_path / "clip", "--out", tmp_path / "out")
    assert said.code == 2
    assert re.search(error, said.errors[0])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["track", "live"])
@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('clip = "x"\nsizze = "1x1"', "unknown setting sizze"),
        ('clip = "x"\nevery = "two"', "every must be a whole number, got text"),
        ('clip = "x"\nsize = "huge"', "size must look like 160x120, got 'huge'"),
        ("clip =", "a value is missing"),
        ("", r"bad\.toml: there is nothing to look at: set clip, or cameras"),
    ],
    ids=["unknown", "ill-typed", "meaningless", "no TOML", "none"],
)
def test_unknown_and_ill_typed_settings_are_refused(
    tritrack: Commands, no_process: None, tmp_path: Path, command: str, text: str, error: str
) -> None:
    said = tritrack(command, toml(tmp_path / "bad.toml", text), "--out", tmp_path / "out")
    assert said.code == 2
    assert re.search(error, said.errors[0])


@pytest.mark.slow
@pytest.mark.parametrize("how", WORKED_WITH)
def test_what_can_be_worked_with_runs_on_with_one_line(
    tritrack: Commands, clip: Path, tmp_path: Path, how: str
) -> None:
    """Beside it JSON stands alone on stdout."""
    spoil, warning = WORKED_WITH[how]
    spoil(copied(clip, tmp_path / "clip"))
    said = tritrack("track", tmp_path / "clip", "--out", tmp_path / "out", "--json")
    assert (said.code, said.errors) == (0, [])
    told = [line for line in said.warnings if re.search(warning, line)]
    assert len(told) == 1
    summary = json.loads((tmp_path / "out" / "clip" / "summary.json").read_text())
    alone = json.loads(said.out)["clips"]["clip"]
    assert alone["warnings"] == summary["warnings"]
    assert alone["scale_source"] == ("person" if how in OF_THE_PERSON else "calibrated")
    assert len(said.warnings) == len(alone["warnings"])
    named = [" ".join(f"warning: clip: {text}".split()) for text in summary["warnings"]]
    assert told[0] in named
    with np.load(tmp_path / "out" / "clip" / "poses.npz", allow_pickle=False) as found:
        assert np.isfinite(found["joints_m"]).all(axis=(1, 2)).sum() > 30


def test_a_good_clip_gives_no_warning(
    tritrack: Commands, as_tracked: list[Settings], clip: Path, tmp_path: Path
) -> None:
    said = tritrack("track", clip, "--out", tmp_path)
    assert (said.code, said.out) == (0, "")
    told = f"1 clip tracked, written to {tmp_path}; believed in 100% of the frames with a person\n"
    assert said.err == told


@pytest.mark.slow
def test_a_clip_that_is_hardly_followed_ends_with_a_code_of_its_own(
    tritrack: Commands, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was found is written all the same, and says so."""
    monkeypatch.setattr("integrator.belief.is_believed", lambda *_: False)
    said = tritrack("track", clip, "--out", tmp_path)
    assert said.code == 3
    assert "followed in less than half" in said.errors[0]
    summary = json.loads((tmp_path / clip.name / "summary.json").read_text())
    assert summary["believed"] < 0.2
    assert summary["status"]["lost"] > summary["status"]["predicted"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "spoil", "short"),
    [
        ("track", cut_off, "cam2.avi"),
        ("single", lambda folder: damage(folder / "cam1.avi", 30_000), "cam1.avi"),
    ],
    ids=["a view is cut off", "damaged in the middle"],
)
def test_a_clip_that_is_not_read_to_its_end_is_written_as_far_as_it_goes(
    tritrack: Commands,
    clip: Path,
    tmp_path: Path,
    command: str,
    spoil: Callable[[Path], object],
    short: str,
) -> None:
    """With how many of its frames were read, and a code of its own."""
    folder = copied(clip, tmp_path / "clip")
    spoil(folder)
    said = tritrack(command, folder, "--out", tmp_path / "out")
    run = tmp_path / "out" / "clip"
    (lost,) = json.loads((run / "summary.json").read_text())["unread"].items()
    assert lost[0] == str(folder / short)
    assert 10 < lost[1]["read"] < lost[1]["of"] == 69
    assert any(f"{lost[1]['read']} of 69 frames could be read" in line for line in said.warnings)
    assert said.code == 3
    assert f"{short}: {lost[1]['read']} of 69" in said.errors[-1]
    with np.load(run / "poses.npz", allow_pickle=False) as found:
        assert np.isfinite(found["joints_m"]).all(axis=(1, 2)).any()


@pytest.mark.slow
@pytest.mark.parametrize("command", ["track", "single"])
def test_a_clip_that_shows_nobody_is_not_followed_and_is_written(
    tritrack: Commands, clip: Path, tmp_path: Path, command: str
) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: 4 * film[:8])
    said = tritrack(command, folder, "--out", tmp_path / "out", "--json")
    assert said.code == 3
    assert said.errors[-1].startswith("error: in 1 of 1 clip the body is followed in less than")
    assert "(clip: nobody was found)" in said.errors[-1]
    assert json.loads(said.out)["clips"]["clip"]["believed"] is None
    assert (tmp_path / "out" / "clip" / "poses.npz").is_file()


def test_a_pattern_may_catch_calibration_json_too(
    tritrack: Commands, as_tracked: list[Settings], clip: Path, tmp_path: Path
) -> None:
    """`tritrack track clips/*`."""
    said = tritrack("track", *sorted(clip.parent.iterdir()), "--out", tmp_path)
    assert said.code == 0
    assert [settings.clip for settings in as_tracked] == [str(clip)]
    assert len(said.warnings) == 1
    assert "calibration.json is neither a clip folder nor a settings file" in said.warnings[0]
    alone = tritrack("track", clip.parent / "calibration.json", "--out", tmp_path)
    assert (alone.code, len(alone.errors)) == (2, 1)


def test_two_runs_never_share_a_folder(tritrack: Commands, clip: Path, tmp_path: Path) -> None:
    again = copied(clip, tmp_path / clip.name)
    said = tritrack("track", clip, again, "--out", tmp_path / "out")
    assert said.code == 2
    assert f"would both be written to {clip.name}" in said.errors[0]
    assert not (tmp_path / "out").exists()


def test_a_bad_clip_does_not_keep_the_others_from_it(
    tritrack: Commands,
    monkeypatch: pytest.MonkeyPatch,
    tracked_clip: Tracked,
    clip: Path,
    tmp_path: Path,
) -> None:
    (tmp_path / "hollow").mkdir()

    def track(settings: Settings, *given: Any, **named: Any) -> Tracked:
        return tracked_clip if settings.clip == str(clip) else track_clip(settings, *given, **named)

    monkeypatch.setattr(batch, "track_clip", track)
    said = tritrack("track", tmp_path / "hollow", clip, "--out", tmp_path / "out")
    assert said.code == 2
    assert "1 of 2 clips could not be tracked" in said.errors[-1]
    assert (tmp_path / "out" / clip.name / "poses.npz").is_file()


def test_settings_hold_unless_the_command_line_says_otherwise(
    tritrack: Commands, as_tracked: list[Settings], clip: Path, tmp_path: Path
) -> None:
    small = toml(tmp_path / "small.toml", f'clip = "{clip}"\nsize = "80x60"\nmode = "paper"\n')

    def resolved(*options: str) -> tuple[str, str]:
        assert tritrack("track", small, "--out", tmp_path, *options).code == 0
        told = json.loads((tmp_path / "small" / "summary.json").read_text())
        assert told["clip"] == "small"
        assert told["settings"] == msgspec.to_builtins(as_tracked[-1])
        return told["settings"]["size"], told["settings"]["mode"]

    assert resolved() == ("80x60", "paper")
    assert resolved("--size", "96x96", "--mode", "default") == ("96x96", "default")
    said = tritrack("track", small, "--out", tmp_path, "--size", "banana")
    assert "size must look like 160x120, got 'banana'" in said.errors[0]


@pytest.mark.slow
@pytest.mark.parametrize("view", [1, 2])
def test_one_view_is_enough(tritrack: Commands, clip: Path, tmp_path: Path, view: int) -> None:
    """A run with one viewer; rows are counted by its own frames."""
    both = copied(clip, tmp_path / "both")
    refilmed(both, lambda film: film[:40])
    folder = Path(shutil.copytree(both, tmp_path / "alone"))
    (folder / f"cam{3 - view}.avi").unlink()
    refused = tritrack("track", folder, "--out", tmp_path / "out")
    assert refused.code == 2
    assert f"and no cam{3 - view}.*" in refused.errors[0]
    for path in (both, folder):
        given = ("track", path, "--views", str(view), "--out", tmp_path / "out")
        assert tritrack(*given).code == 0
        with np.load(tmp_path / "out" / path.name / "poses.npz", allow_pickle=False) as found:
            assert found["frame"].tolist() == list(range(40))
            assert set(found["views"]) == {"none", str(view)}
            assert np.isfinite(found["joints_m"][12:]).all()


def test_a_view_that_is_not_there_is_named(tritrack: Commands, clip: Path, tmp_path: Path) -> None:
    folder = copied(clip, tmp_path / "alone")
    (folder / "cam2.avi").unlink()
    said = tritrack("track", folder, "--views", "2", "--out", tmp_path / "out")
    assert said.code == 2
    assert "alone has cam1.avi and no cam2.*: add it" in said.errors[0]


def test_live_refuses_a_model_trained_on_other_postures(
    tritrack: Commands, no_process: None, clip: Path, tmp_path: Path
) -> None:
    folder = copied(clip, tmp_path / "clip")
    edit_json(folder / "meta.json", lambda meta: meta.update(posture="somersault"))
    said = tritrack("live", folder, "--out", tmp_path / "out")
    assert said.code == 2
    assert "postures.npz was trained on other postures than 'somersault'" in said.errors[0]
    assert "tritrack train" in said.errors[0]
    assert not (tmp_path / "out").exists()


def test_live_refuses_an_unreadable_model(
    tritrack: Commands, no_process: None, clip: Path, tmp_path: Path
) -> None:
    (tmp_path / "model.npz").write_text("no model")
    text = f'clip = "{clip}"\n[recognizer]\nmodel = "model.npz"\n'
    said = tritrack("live", toml(tmp_path / "run.toml", text), "--out", tmp_path / "out")
    assert said.code == 2
    assert "no usable posture model in" in said.errors[0]


def test_live_refuses_a_page_port_in_use(
    tritrack: Commands, no_process: None, clip: Path, tmp_path: Path
) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        text = f'clip = "{clip}"\n[page]\nport = {taken.getsockname()[1]}\n'
        said = tritrack("live", toml(tmp_path / "run.toml", text), "--out", tmp_path / "out")
    assert said.code == 2
    assert re.search(r"port \d+: .*in use; .*set page\.port to another one$", said.errors[0])


def test_a_live_run_takes_the_place_of_no_other_run(
    tritrack: Commands, no_process: None, clip: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    write_run(out, [], Settings(), run_of("single", ["dance.avi"]).facts)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    said = tritrack("live", clip, "--out", out)
    assert said.code == 2
    assert re.search(r"another run \(tritrack single of .*dance.avi\): .*--force", said.errors[0])
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


@pytest.mark.parametrize("words", [(), ("--out", "out"), ("--out", "other", "--force")])
def test_a_live_run_takes_the_place_of_the_last_one_of_the_same_or_by_force(
    tritrack: Commands,
    monkeypatch: pytest.MonkeyPatch,
    clip: Path,
    tmp_path: Path,
    words: tuple[str, ...],
) -> None:
    """It is let in: what refuses it here, a mode that has no processes, comes behind that."""
    monkeypatch.chdir(tmp_path)
    films = [str(clip / "cam1.avi"), str(clip / "cam2.avi")]
    for place, sources in (("out", films), ("other", ["dance.avi"]), ("runs/live", ["dance.avi"])):
        write_run(tmp_path / place, [], Settings(), run_of("live", sources).facts)
    settings = toml(tmp_path / "run.toml", f'clip = "{clip}"\nmode = "thesis"\n')
    said = tritrack("live", settings, *words)
    assert "the thesis's mode is not for live runs" in said.errors[0]
    told = re.search(r"runs/live holds another run \(.*\): this one replaces it", said.err)
    assert (told is not None) == (words == ())


@pytest.mark.slow
def test_what_is_replayed_says_where_it_is_written(
    tritrack: Commands, recorded_run: Path, tmp_path: Path
) -> None:
    pytest.importorskip("mcap", reason="pip install 'tritrack[mcap]'")
    out = tmp_path / "again"
    said = tritrack("replay", recorded_run, "--out", out)
    assert said.err.strip().endswith(f"; written to {out}")
    assert "written" not in tritrack("replay", recorded_run).err


def test_calibration_is_a_table_and_json(tritrack: Commands, tmp_path: Path) -> None:
    """configs/markers.toml says itself: camera 1 looks 1.5 degrees too far right."""
    configs = Path(__file__).parents[1] / "configs"
    markers = configs / "markers.toml"
    aims = json.loads(tritrack("calibrate", "markers", markers, "--json").out)
    assert [aim["name"] for aim in aims] == ["cam1", "cam2"]
    assert aims[0]["yaw_deg"] == pytest.approx(1.5, abs=0.05)
    table = tritrack("calibrate", "markers", markers).out
    assert re.search(r"cam1 +1\.5\d +-0\.8\d", table)
    out = tmp_path / "calibration.json"
    poles = tritrack("calibrate", "poles", configs / "poles.toml", "--out", out, "--json")
    assert json.loads(poles.out)[1]["focal_px"] == pytest.approx(640, abs=10)
    assert out.is_file()


def test_a_calibration_that_is_there_is_replaced_only_when_asked(
    tritrack: Commands, tmp_path: Path
) -> None:
    points = Path(__file__).parents[1] / "configs" / "poles.toml"
    out = tmp_path / "calibration.json"
    out.write_text("an afternoon's work")
    words = ("calibrate", "poles", points, "--out", out)
    said = tritrack(*words)
    assert (said.code, said.out) == (2, "")
    assert said.errors == [f"error: {out} is there already: name another --out, or add --force"]
    assert out.read_text() == "an afternoon's work"
    assert tritrack(*words, "--force").code == 0
    assert json.loads(out.read_text())["cameras"]


def test_an_export_replaces_a_file_only_when_asked(tritrack: Commands, tmp_path: Path) -> None:
    run, out = tmp_path / "run", tmp_path / "a.csv"
    write_run(run, [], Settings(), {})
    out.write_text("an afternoon's work")
    words = ("export", run, "--to", "csv", "--out", out)
    said = tritrack(*words)
    assert (said.code, said.out) == (2, "")
    assert said.errors == [f"error: {out} is there already: name another --out, or add --force"]
    assert out.read_text() == "an afternoon's work"
    assert tritrack(*words, "--force").code == 0
    assert out.read_text().startswith("frame,")


@pytest.mark.parametrize("what", ["postures", "proposals", "silhouettes", "landmarks"])
def test_what_is_learnt_replaces_a_file_only_when_asked(
    tritrack: Commands, tmp_path: Path, what: str
) -> None:
    out = tmp_path / "model.npz"
    out.write_text("an afternoon's work")
    said = tritrack("train", "nosuch", "--what", what, "--out", out)
    assert said.code == 2
    assert said.errors == [f"error: {out} is there already: name another --out, or add --force"]
    assert out.read_text() == "an afternoon's work"


def test_what_is_learnt_goes_on_from_the_work_beside_it_or_by_force(
    tritrack: Commands, tmp_path: Path
) -> None:
    """It is let in: what refuses it here, a film or clips that are not there, comes behind."""
    out = tmp_path / "mine.onnx"
    out.write_text("a network")
    (tmp_path / "mine.onnx.work").mkdir()
    film = ("--what", "landmarks", "--film", tmp_path / "nosuch.mp4", "--teacher", tmp_path)
    assert "is there already" not in tritrack("train", *film, "--out", out).err
    assert "is there already" in tritrack("train", "--out", out).err
    assert "name clips or run folders" in tritrack("train", "--out", out, "--force").err
    assert out.read_text() == "a network"


@pytest.mark.parametrize(
    "words",
    [
        ("export", "x", "--to", "csv"),
        ("train", "x", "--force"),
        ("teach", "bow", "x"),
        ("calibrate", "poles", "x", "--force"),
    ],
    ids=lambda words: words[0],
)
def test_what_is_no_ordinary_file_is_refused_before_any_work(
    tritrack: Commands, tmp_path: Path, words: tuple[str, ...]
) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    said = tritrack(*words, "--out", pipe)
    assert (said.code, said.out) == (2, "")
    assert said.errors == [f"error: {pipe} is no ordinary file: name another --out"]
    assert pipe.is_fifo()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["person", "nope"], "there is no clip folder and no settings file nope: check the path"),
        (["board", "nope.mp4", "none.mp4"], "there is no file nope.mp4: check the path"),
        (["poles", "nope.toml"], "cannot read the points nope.toml: No such file or directory"),
        (
            ["import", "nope.toml", "--out", "calibration.json"],
            "cannot read the calibration nope.toml: No such file",
        ),
    ],
    ids=["person", "board", "poles", "import"],
)
def test_what_a_calibration_lacks_is_said_before_that_one_is_there(
    tritrack: Commands,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    says: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("calibration.json").write_text("an afternoon's work")
    said = tritrack("calibrate", *words)
    assert (said.code, len(said.errors)) == (2, 1)
    assert said.errors[0].startswith(f"error: {says}")


def test_an_imported_calibration_goes_where_the_user_says_and_nowhere_else(
    tritrack: Commands, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the working folder it would be that of every clip below."""
    monkeypatch.chdir(tmp_path)
    rig = paper_rig((320, 240), (400.0, 400.0), (4.5, 4.5))
    Path("theirs.toml").write_text(toml_text(rig, "caliscope"))
    said = tritrack("calibrate", "import", "theirs.toml")
    assert (said.code, len(said.errors)) == (2, 1)
    assert "--out" in said.errors[0]
    assert not Path("calibration.json").exists()
    assert tritrack("calibrate", "import", "theirs.toml", "--out", "ours.json").code == 0
    assert load_rig(Path("ours.json")).cameras[1].name == "cam_1"


def test_a_board_that_is_there_is_kept_and_the_option_that_named_it_is_told(
    tritrack: Commands, tmp_path: Path
) -> None:
    pytest.importorskip("matplotlib", reason="pip install 'tritrack[report]'")
    there = tmp_path / "board.pdf"
    there.write_text("printed")
    said = tritrack("calibrate", "board", "--print", there)
    told = f"error: {there} is there already: name another --print, or add --force"
    assert (said.code, said.errors) == (2, [told])


def test_made_up_clips_are_told_as_json(tritrack: Commands, tmp_path: Path) -> None:
    words = ("--size", "64x48", "--posture", "squat", "--json")
    said = tritrack("synth", "--out", tmp_path / "clips", *words)
    assert said.code == 0
    (folder,) = json.loads(said.out)["clips"]
    assert (Path(folder) / "truth.npz").is_file()


@pytest.mark.slow
def test_a_full_disk_leaves_no_broken_file(clip: Path, recorded_run: Path, tmp_path: Path) -> None:
    """Nothing may grow beyond 20 kB here; the poses of 69 frames need 120. What fits is kept.

    What is compiled would not fit either: the run before has done that.
    """
    assert (recorded_run / "poses.npz").stat().st_size > 20_000

    ended = subprocess.run(
        [sys.executable, "-m", "tritrack", "track", str(clip), "--out", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
    )
    assert ended.returncode == 2
    assert f"error: cannot write {tmp_path / 'out' / clip.name}: File too large" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert sorted(os.listdir(tmp_path / "out" / clip.name)) == ["journal.bin", "unfinished"]
    assert 0 < len(open_run(tmp_path / "out" / clip.name).poses["frame"]) < 69


def test_tritrack_alone_opens_the_start_page_on_a_terminal_only(
    tritrack: Commands, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")
    from tritrack.starting import start

    opened: list[object] = []
    monkeypatch.setattr(start, "start", lambda *given: opened.append(given[0]))
    monkeypatch.chdir(tmp_path)
    for stream in ("stdin", "stdout"):
        assert tritrack().code == 2
        monkeypatch.setattr(getattr(sys, stream), "isatty", lambda: True)
    assert opened == []
    assert tritrack().code == 0
    (given,) = opened
    assert given.runs == Path("runs")  # type: ignore[attr-defined]
