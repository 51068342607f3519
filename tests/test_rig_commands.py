"""What is typed to calibrate reaches what does the work; nothing is replaced unasked."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from typed import Called, instead, typed

from calibration.board.board_quality import CameraQuality
from calibration.paper.calibration import write_rig
from calibration.tracks.lateness import Clock
from common.atomic_file import FileRefused
from common.rig.camera import paper_rig
from common.rig.rig_file import load_rig
from runtime.offline.rig_of_boards import Shown
from runtime.offline.rig_of_clips import FoundByClips, Given
from tritrack.commands.rig_commands import calibrate_app
from tritrack.marking.marking import Asked, Result

RIG = paper_rig((320, 240), (400.0, 400.0), (4.0, 4.0))
CLOCKS = (Clock(0.0), Clock(-0.15, (1.2,)))
CAMERAS = (CameraQuality("cam1", 400.0, 1.0, 0.0, 0.0, 0.1, 9, 0.5),)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def quality(**more: Any) -> Any:
    found = {"cameras": CAMERAS, "late_frames": (0.04, -2.26), "gap_mm": 12.4, "moments": 30}
    return SimpleNamespace(**{**found, "unsure": (), **more})


@pytest.fixture
def by_clips(monkeypatch: pytest.MonkeyPatch) -> Called:
    instead(monkeypatch, "common.video.clip_sources.refuse_no_source")
    instead(monkeypatch, "common.config.config_file.load")
    instead(monkeypatch, "calibration.paper.calibration.write_rig")
    place = "runtime.offline.rig_of_clips.calibrated_by_clips"
    return instead(monkeypatch, place, FoundByClips(RIG, quality(), CLOCKS))


def test_a_person_of_the_stature_that_is_typed_calibrates_all_clips(by_clips: Called) -> None:
    said = typed(
        calibrate_app, "person", "a", "b", "--stature", 1.9, "--fov", 60, "--out", "r.json"
    )
    assert by_clips.last == ([Path("a"), Path("b")], Given(1.9, 60.0))
    assert (
        "both views agree to 12 mm in 30 moments; view 2 is late by +0.0, -2.3 (ambiguous) frames"
        in said.output
    )
    assert "written to r.json" in said.output
    assert "not known" not in said.output
    unsure = quality(unsure=("focal lengths to 9 % only", "clocks"))
    by_clips.answer = FoundByClips(RIG, unsure, CLOCKS)
    said = typed(calibrate_app, "person", "a", "--json")
    assert by_clips.last == ([Path("a")], Given(1.75, None))
    assert "not known well enough: focal lengths to 9 % only, clocks: record" in said.output
    assert '"focal_px": 400.0' in said.output
    word = "a: view 2 is -0.50 s late: its times were set back by that, as the sound tells"
    by_clips.answer = FoundByClips(RIG, quality(), CLOCKS, (word,))
    assert word in typed(calibrate_app, "person", "a").output


def test_a_view_that_is_late_by_next_to_nothing_is_late_by_plus_nothing(by_clips: Called) -> None:
    late = quality(late_frames=(-0.04, 0.04))
    by_clips.answer = FoundByClips(RIG, late, (Clock(0.0), Clock(0.0)))
    said = typed(calibrate_app, "person", "a", "b")
    assert "view 2 is late by +0.0, +0.0 frames" in said.output


def test_a_calibration_that_is_there_is_replaced_only_by_force(
    by_clips: Called, here: Path
) -> None:
    (here / "calibration.json").write_text("mine")
    with pytest.raises(FileRefused):
        typed(calibrate_app, "person", "a")
    assert not by_clips.given
    assert typed(calibrate_app, "person", "a", "--force").exit_code == 0


def test_a_board_is_printed_or_looked_for_as_it_was_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    printed = instead(monkeypatch, "calibration.board.board_print.print_board")
    readable = instead(monkeypatch, "common.video.clip_sources.refuse_unreadable")
    found = SimpleNamespace(cameras=CAMERAS, reprojection_px=0.123, shared_rests=1, floor_s=7.04)
    place = "runtime.offline.rig_of_boards.calibrate_by_videos"
    done = instead(monkeypatch, place, (found, Path("seen.png")))
    said = typed(calibrate_app, "board", "--print", "b.pdf", "--paper", "a4")
    assert printed.last == (Path("b.pdf"), "a4")
    assert "written to b.pdf" in said.output
    assert not done.given
    words = ["--square", 31.5, "--chessboard", "9x6", "--floor", 4, "--out", "r.json"]
    said = typed(calibrate_app, "board", "1.mp4", "2.mp4", *words)
    videos, shown, out, _ = done.last
    assert (videos, shown, out) == (
        [Path("1.mp4"), Path("2.mp4")],
        Shown(31.5, "9x6", 4.0),
        Path("r.json"),
    )
    assert readable.given == [(Path("1.mp4"),), (Path("2.mp4"),)]
    told = " ".join(said.output.split())
    assert "corners miss by 0.12 px; 1 pose seen by several cameras" in told
    assert "on the floor at 7.0 s written to r.json" in told
    assert "to seen.png" in told
    assert len(printed.given) == 1
    said = typed(calibrate_app, "board")
    assert (said.exit_code, "name the video of each camera" in said.output) == (2, True)
    typed(calibrate_app, "board", "--print", "c.pdf")
    assert printed.last == (Path("c.pdf"), "a3")


def test_nothing_is_printed_or_calibrated_over_what_is_there(
    monkeypatch: pytest.MonkeyPatch, here: Path
) -> None:
    printed = instead(monkeypatch, "calibration.board.board_print.print_board")
    done = instead(monkeypatch, "runtime.offline.rig_of_boards.calibrate_by_videos")
    instead(monkeypatch, "common.video.clip_sources.refuse_unreadable")
    for name in ("b.pdf", "calibration.json"):
        (here / name).write_text("mine")
    for words in (("--print", "b.pdf"), ("1.mp4", "2.mp4")):
        with pytest.raises(FileRefused):
            typed(calibrate_app, "board", *words)
    assert printed.given == done.given == []


class Row(msgspec.Struct, frozen=True):
    """Of one camera."""

    name: str


ROWS = [Row("cam7")]


def test_markers_are_read_from_a_file_or_clicked_on_a_page(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    read = instead(monkeypatch, "calibration.paper.calibration.run_markers", ROWS)
    paged = instead(monkeypatch, "tritrack.marking.marking.mark_markers", Result(ROWS, None, None))  # type: ignore[arg-type]
    assert "cam7" in typed(calibrate_app, "markers", "m.toml", "--json").output
    assert (read.last, paged.given) == ((Path("m.toml"),), [])
    said = typed(calibrate_app, "markers", "m.toml", "--page", "clip", "--port", 9000, "--json")
    assert paged.last[0] == Asked(Path("clip"), Path("m.toml"), 9000)
    assert "cam7" in said.output
    assert len(read.given) == 1


@pytest.mark.parametrize(
    ("saved", "newest", "told"),
    [
        (None, "b", "no calibration was saved"),
        ("b", "b", "written to r.json"),
        ("a", "b", "written to r.json, without what was changed since then; to take that in:"),
    ],
)
def test_of_poles_on_a_page_is_said_what_became_of_the_calibration(
    monkeypatch: pytest.MonkeyPatch, saved: Any, newest: Any, told: str
) -> None:
    paged = instead(monkeypatch, "tritrack.marking.marking.mark_poles", Result(ROWS, saved, newest))
    said = typed(calibrate_app, "poles", "p.toml", "--page", "clip", "--out", "r.json")
    assert paged.last[:2] == (Asked(Path("clip"), Path("p.toml"), None), Path("r.json"))
    assert told in said.output
    assert ("--force" in said.output) is (saved == "a")


def test_poles_of_a_file_are_solved_at_once(monkeypatch: pytest.MonkeyPatch, here: Path) -> None:
    place = "calibration.paper.calibration.run_poles"
    solved = instead(monkeypatch, place, SimpleNamespace(cameras=ROWS))
    said = typed(calibrate_app, "poles", "p.toml", "--out", "r.json", "--force")
    assert solved.last == (Path("p.toml"), Path("r.json"), True)
    assert "written to r.json" in said.output
    (here / "r.json").write_text("mine")
    paged = instead(monkeypatch, "tritrack.marking.marking.mark_poles")
    with pytest.raises(FileRefused):
        typed(calibrate_app, "poles", "p.toml", "--page", "clip", "--out", "r.json")
    assert not paged.given


def test_a_rig_goes_to_another_program_and_comes_back(here: Path) -> None:
    write_rig(here / "ours.json", RIG)
    said = typed(calibrate_app, "export", "ours.json", "--to", "pose2sim", "--out", "theirs.toml")
    assert "written to theirs.toml" in said.output
    with pytest.raises(FileRefused):
        typed(calibrate_app, "export", "ours.json", "--to", "pose2sim", "--out", "theirs.toml")
    words = ["--camera", "cam2", "--camera", "cam1"]
    said = typed(calibrate_app, "import", "theirs.toml", *words, "--out", "back.json")
    assert "2 cameras written to back.json" in said.output
    back = load_rig(here / "back.json")
    assert np.array(back.cameras[0].K) == pytest.approx(np.array(RIG.cameras[1].K))
    with pytest.raises(FileRefused):
        typed(calibrate_app, "import", "theirs.toml", *words, "--out", "back.json")


def test_what_is_found_is_written_and_what_shows_nothing_is_refused_before(
    by_clips: Called, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = instead(monkeypatch, "calibration.paper.calibration.write_rig")
    looked = instead(monkeypatch, "common.video.clip_sources.refuse_no_source")
    typed(calibrate_app, "person", "a", "b", "--out", "r.json")
    rig, quality_told, *_ = by_clips.answer
    assert written.last == (Path("r.json"), rig, quality_told)
    assert [given[1] for given in looked.given] == [Path("a"), Path("b")]


@pytest.mark.parametrize(
    ("words", "needs"),
    [
        (("board", "--print", "b.pdf"), ("report", "matplotlib")),
        (("markers", "m.toml", "--page", "clip"), ("page", "websockets")),
        (("poles", "p.toml", "--page", "clip"), ("page", "websockets")),
    ],
)
def test_what_a_command_lacks_is_said_before_it_begins(
    monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], needs: tuple[str, ...]
) -> None:
    lacks = instead(monkeypatch, "tritrack.commands.rig_commands.refuse_without")
    instead(monkeypatch, "calibration.board.board_print.print_board")
    for name in ("mark_markers", "mark_poles"):
        result = Result((), None, None)  # type: ignore[arg-type]
        instead(monkeypatch, f"tritrack.marking.marking.{name}", result)
    typed(calibrate_app, *words)
    assert lacks.given == [needs]
