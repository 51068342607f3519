"""What a command line names as clips: folders and settings files, and what a video is for."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from runtime.store.clip_paths import ClipsFailed, run_names, without_plain_files


def console() -> Console:
    return Console(file=StringIO(), width=999)


def test_who_names_a_video_hears_of_the_command_that_is_for_it(tmp_path: Path) -> None:
    video = tmp_path / "walk.MP4"
    video.write_bytes(b"")
    with pytest.raises(
        ClipsFailed, match=rf"no clip is left: name a folder .*; of one video: .* single {video}$"
    ):
        without_plain_files([video], console())


def test_who_names_what_stands_beside_videos_does_not(tmp_path: Path) -> None:
    (tmp_path / "calibration.json").write_text("{}")
    with pytest.raises(ClipsFailed, match=r"or a settings file$"):
        without_plain_files([tmp_path / "calibration.json"], console())


def test_what_is_no_clip_is_left_out_and_said(tmp_path: Path) -> None:
    (tmp_path / "walk.mp4").write_bytes(b"")
    (tmp_path / "live.toml").write_text("")
    said = console()
    paths = [tmp_path, tmp_path / "walk.mp4", tmp_path / "live.toml", tmp_path / "absent"]
    assert without_plain_files(paths, said) == [paths[0], paths[2], paths[3]]
    assert said.file.getvalue().count("left out") == 1  # type: ignore[attr-defined]


def test_two_clips_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ClipsFailed, match="would both be written to walk"):
        run_names([tmp_path / "a" / "walk", tmp_path / "b" / "walk"])


def test_a_run_is_called_after_its_clip_or_its_settings_file(tmp_path: Path) -> None:
    folder, settings = tmp_path / "dance.v2", tmp_path / "gym.toml"
    folder.mkdir()
    settings.write_text("")
    assert run_names([folder, settings]) == {"dance.v2": folder, "gym": settings}
    assert run_names([folder / ".." / "dance.v2"]).keys() == {"dance.v2"}
