"""What dropped files are, one by one and together."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from test_sound_clocks import claps

from common.video.decoding import Decoder
from common.video.pictures import VideoInfo
from tritrack.starting import tray
from tritrack.starting.tray import Facts, facts_of, shown_tray, together, words_of
from tritrack.starting.uploads import Upload

WALK = VideoInfo(width=640, height=480, fps=15.0, frames=150)


def whole(number: int, name: str) -> Upload:
    return Upload(number, Path(name), 100, 100)


def test_a_videos_facts_are_read_from_it(tmp_path: Path) -> None:
    path = tmp_path / "cam1.avi"
    video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 20.0, (120, 160))
    for grey in range(30):
        video.write(np.full((160, 120, 3), 8 * grey, np.uint8))
    video.release()
    with Decoder() as decoder:
        found = facts_of(Upload(1, path, 1, 1), decoder)
        assert found.info is not None
        assert words_of(found.info) == "1.5 s, 30 frames at 20 a second, 120x160, upright"
        path.write_bytes(b"no video")
        said = facts_of(Upload(1, path, 1, 1), decoder).fault
    assert said.startswith("cam1.avi")
    assert str(tmp_path) not in said


def test_a_text_is_no_video(tmp_path: Path) -> None:
    """As for the commands."""
    notes = tmp_path / "notes.nfo"
    notes.write_text("a walk, on Monday\n" * 300)
    with Decoder() as decoder:
        fault = facts_of(Upload(1, notes, 5400, 5400), decoder).fault
    assert fault.startswith("notes.nfo is text, no video")


def test_a_picture_is_no_video_nor_is_a_file_twice(tmp_path: Path) -> None:
    picture, one, other = tmp_path / "photo.png", tmp_path / "a.avi", tmp_path / "b.avi"
    cv2.imwrite(str(picture), np.zeros((100, 100, 3), np.uint8))
    one.write_bytes(b"x" * 100)
    other.write_bytes(b"x" * 100)
    with Decoder() as decoder:
        size = picture.stat().st_size
        assert "one picture, no video" in facts_of(Upload(1, picture, size, size), decoder).fault
        first, second = Upload(1, one, 100, 100, "walk 1.avi"), Upload(2, other, 100, 100)
        found = facts_of(second, decoder, [first])
        assert found == Facts(fault="the same file as walk 1.avi: take one away", twin=1)
        other.write_bytes(b"y" * 100)
        assert facts_of(second, decoder, [first]).twin is None


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (VideoInfo(width=640, height=480, fps=25.0, frames=250), "Their rates differ"),
        (VideoInfo(width=640, height=480, fps=15.0, frames=165), "Their lengths differ"),
    ],
)
def test_what_differs_between_two_is_said(other: VideoInfo, says: str) -> None:
    names = ["a.avi", "b.avi"]
    assert says in together(names, [WALK, other])
    assert says not in together(names, [WALK, WALK])
    assert "a.avi is camera 1" in together(names, [WALK, other])


def test_how_late_a_video_is_by_its_sound_stands_beside_it() -> None:
    files, facts = [whole(1, "a.avi"), whole(2, "b.avi")], {1: Facts(WALK), 2: Facts(WALK)}
    first, second = shown_tray(files, facts, {(1, 2): -1.25, (2, 1): 1.25}).files
    assert "late" not in first.facts
    assert second.facts.endswith(", -1.25 s late by its sound")
    first, second = shown_tray(files[::-1], facts, {(1, 2): -1.25, (2, 1): 1.25}).files
    assert second.facts.endswith(", +1.25 s late by its sound")
    assert "late" not in shown_tray(files, facts, {(1, 2): None}).files[1].facts


def test_the_sounds_of_two_videos_tell_how_late_one_is(monkeypatch: pytest.MonkeyPatch) -> None:
    sounds = {"a.avi": claps(0.0, 2), "b.avi": claps(-1.234, 3), "quiet.avi": None}
    monkeypatch.setattr(tray, "sound_of", lambda path: sounds[path.name])
    late_s = tray.late_by_sound(Path("a.avi"), Path("b.avi"))
    assert late_s == pytest.approx(-1.234, abs=0.01)
    assert tray.late_by_sound(Path("a.avi"), Path("quiet.avi")) is None


def test_nothing_can_be_done_before_all_came_and_could_be_read() -> None:
    files = [whole(1, "a.avi"), whole(2, "b.avi")]
    assert shown_tray(files, {1: Facts(WALK), 2: Facts(WALK)}).tasks == (
        *("track", "person", "board", "poles", "markers"),
    )
    assert shown_tray(files, {1: Facts(WALK)}).tasks == ()
    spoilt = shown_tray(files, {1: Facts(WALK), 2: Facts(fault="b.avi is empty")})
    assert (spoilt.tasks, spoilt.files[1].fault) == ((), "b.avi is empty")
    assert shown_tray([], {}).tasks == ()


def test_a_calibration_is_taken_over_by_itself() -> None:
    one = whole(1, "Calib.toml")
    assert shown_tray([one], {1: Facts()}).tasks == ("import",)
    both = shown_tray([one, whole(2, "a.avi")], {1: Facts(), 2: Facts(WALK)})
    assert both.tasks == ()
    assert "take the other files away" in both.says
