"""The keys and files of what was tracked: the same clip and settings, and nothing else, match."""

import shutil
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest
from spoiling import changed, copied, edit_json

from common.bus.messages import Body
from common.config.settings import Settings
from common.video.clip_sources import ClipError
from runtime.offline import clip_cache
from runtime.offline.clip_cache import key_of, packed, read, write
from runtime.offline.lockstep import Tracked


@pytest.fixture
def own(clip: Path, tmp_path: Path) -> Settings:
    return Settings(clip=str(copied(clip, tmp_path / "own")))


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: changed(folder / "cam1.avi"),
        lambda folder: changed(folder / "cam2.avi"),
        lambda folder: edit_json(folder / "meta.json", lambda meta: meta.update(take=7)),
        lambda folder: edit_json(folder / "calibration.json", lambda rig: rig.update(fps=14)),
        lambda folder: (folder / "calibration.json").unlink(),
        lambda folder: (folder / "cam2.avi").rename(folder / "cam2.mkv"),
    ],
)
def test_any_file_that_is_read_changes_the_key(
    own: Settings, change: Callable[[Path], object]
) -> None:
    before = key_of(own, "tracker")
    change(Path(own.clip))
    assert key_of(own, "tracker") != before


def test_settings_and_the_tracker_change_the_key_the_truth_does_not(own: Settings) -> None:
    before = key_of(own, "tracker")
    assert key_of(own, "another") != before
    assert key_of(msgspec.structs.replace(own, mode="paper"), "tracker") != before
    assert key_of(msgspec.structs.replace(own, size="80x60"), "tracker") != before
    (Path(own.clip) / "truth.npz").write_bytes(b"")
    assert key_of(own, "tracker") == before


def test_keypoints_from_files_are_of_the_clip(own: Settings, tmp_path: Path) -> None:
    told = tmp_path / "pose" / "cam1" / "0.json"
    told.parent.mkdir(parents=True)
    told.write_text('{"people": []}')
    with_files = msgspec.structs.replace(own, landmarks=str(tmp_path / "pose"))
    before = key_of(with_files, "tracker")
    assert before != key_of(own, "tracker")
    changed(told)
    assert key_of(with_files, "tracker") != before


def test_a_clip_that_moved_keeps_its_key(own: Settings, tmp_path: Path) -> None:
    before = key_of(own, "tracker")
    moved = tmp_path / "elsewhere" / "own"
    shutil.copytree(own.clip, moved)
    assert key_of(Settings(clip=str(moved)), "tracker") == before
    renamed = moved.rename(tmp_path / "another")  # what is kept bears the clip's name
    assert key_of(Settings(clip=str(renamed)), "tracker") != before


def test_a_camera_is_no_recorded_clip(tmp_path: Path) -> None:
    settings = msgspec.convert({"cameras": {"cam1": {"device": 0}}}, Settings)
    with pytest.raises(ClipError, match="camera 0 is no recorded clip"):
        key_of(settings, "tracker")


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_half_a_file_counts_as_none(tmp_path: Path, share: float) -> None:
    np.savez(tmp_path / "whole.npz", facts=np.frombuffer(b"{}", np.uint8), frame=np.arange(99))
    whole = (tmp_path / "whole.npz").read_bytes()
    write(tmp_path, "half", whole[: int(share * len(whole))])
    assert read(tmp_path, "half") is None
    assert read(tmp_path, "never written") is None


def test_a_pickle_is_not_read(tmp_path: Path) -> None:
    arrays = {name: np.array([{}], object) for name in clip_cache.KEPT}
    np.savez(
        tmp_path / "k.npz",
        allow_pickle=True,
        facts=np.frombuffer(b"{}", np.uint8),
        **arrays,
    )
    assert read(tmp_path, "k") is None


def test_what_was_kept_is_read_again(tmp_path: Path) -> None:
    """Three bodies; what recognition does not need is not kept."""
    bodies = [
        Body(frame=n, captured_s=n / 15, clock_s=0.0, status="empty", views="none")
        for n in (2, 3, 5)
    ]
    facts = {"clip": "walk", "warnings": ["it is dark"]}
    tracked = Tracked(None, bodies, facts)  # type: ignore[arg-type]
    write(tmp_path / "new" / "folder", "key", packed(tracked))
    again = read(tmp_path / "new" / "folder", "key")
    assert again is not None
    assert again.facts == facts
    assert tuple(again.arrays) == clip_cache.KEPT
    assert again.arrays["frame"].tolist() == [2, 3, 5]
    assert again.arrays["time_s"].tolist() == [2 / 15, 3 / 15, 5 / 15]
    assert again.arrays["joints_m"].shape == (3, 15, 3)
    assert [*(tmp_path / "new" / "folder").iterdir()] == [tmp_path / "new" / "folder" / "key.npz"]


def test_a_key_is_a_file_name_and_a_missing_clip_is_named(own: Settings, tmp_path: Path) -> None:
    key = key_of(own, "tracker")
    assert (len(key), set(key) <= set("0123456789abcdef")) == (32, True)
    gone = Path(own.clip) / "cam1.avi"
    files = [gone]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(clip_cache, "files_of", lambda _: files)
        gone.unlink()
        with pytest.raises(ClipError, match=r"^cannot read .*cam1\.avi: No such file.*; check"):
            key_of(own, "tracker")
