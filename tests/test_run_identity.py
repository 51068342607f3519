"""Of what a run is: what changes it, and what does not."""

import hashlib
import shutil
from pathlib import Path

import msgspec
import pytest
from spoiling import changed, copied

from common.config.settings import Settings
from common.packages import ROOT
from runtime.unfinished import run_identity
from runtime.unfinished.run_identity import differing, identity_of, tracker_id


def test_a_run_is_another_where_its_settings_or_a_file_are(clip: Path, tmp_path: Path) -> None:
    folder = copied(clip, tmp_path / "clip")
    own = Settings(clip=str(folder))
    before = identity_of(own, {"the views": (1, 2)})
    assert differing(before, identity_of(own, {"the views": (1, 2)})) == []
    assert differing(before, identity_of(own, {"the views": (1,)})) == ["the views"]
    small = msgspec.structs.replace(own, size="80x60")
    assert differing(before, identity_of(small, {"the views": (1, 2)})) == ["the settings"]
    changed(folder / "cam2.avi")
    assert differing(before, identity_of(own, {"the views": (1, 2)})) == ["cam2.avi"]


def test_a_clip_may_lie_elsewhere(clip: Path, tmp_path: Path) -> None:
    before = identity_of(Settings(clip=str(clip)), {})
    moved = copied(clip, tmp_path / "elsewhere")
    assert differing(before, identity_of(Settings(clip=str(moved)), {})) == []


def test_the_tracker_is_named_by_all_our_code_and_by_its_models(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = tracker_id()
    assert tracker_id() == before
    with monkeypatch.context() as patched:
        patched.setattr(run_identity, "SOURCES", "of other sources")
        assert tracker_id() != before
    shutil.copytree(ROOT / "viewer", tmp_path / "viewer")
    monkeypatch.setattr(run_identity, "ROOT", tmp_path)
    for kind in ("*.npz", "*.onnx"):
        before = tracker_id()
        changed(next((tmp_path / "viewer").rglob(kind)))
        assert tracker_id() != before


def test_another_python_or_library_is_another_tracker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_identity, "PACKAGES", ())
    words = {tracker_id()}
    with monkeypatch.context() as patched:
        patched.setattr("sys.version", "3.99")
        words.add(tracker_id())
    for library in run_identity.LIBRARIES:
        with monkeypatch.context() as patched:
            patched.setattr(run_identity, "version", lambda name, newer=library: str(name == newer))
            words.add(tracker_id())
    assert len(words) == 2 + len(run_identity.LIBRARIES)


def test_what_differs_is_told_in_the_order_in_which_it_was_begun() -> None:
    before, now = {"b": "1", "a": "2", "same": "3"}, {"c": "1", "a": "1", "same": "3"}
    assert differing(before, now) == ["b", "a", "c"]


def test_the_background_the_network_and_the_calibration_of_a_clip_are_of_its_run(
    clip: Path, tmp_path: Path
) -> None:
    """The program, the settings, both films, then what stands beside them, each by its name."""
    folder = copied(clip, tmp_path / "clip")
    network = tmp_path / "own.onnx"
    network.write_bytes(b"weights")
    own = Settings(clip=str(folder), landmarks=str(network))
    found = identity_of(own, {"the views": (1, 2)})
    assert [*found] == [
        *("the program", "the settings", "the views"),
        *("cam1.avi", "cam2.avi", "own.onnx", "calibration.json", "meta.json"),
    ]
    assert found["own.onnx"] == hashlib.sha256(b"weights").hexdigest()
    (folder / "cam1.avi").unlink()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run_identity, "files_of", lambda _: [folder / "cam1.avi"])
        assert identity_of(own, {})["cam1.avi"] == "", "who opens it says that it is missing"
