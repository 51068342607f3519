"""Of what a run is: what changes it, and what does not."""

import shutil
from pathlib import Path

import msgspec
import pytest
from spoiling import changed, copied

from common.config.settings import Settings
from common.packages import ROOT
from tritrack.unfinished import run_identity
from tritrack.unfinished.run_identity import differing, identity_of, tracker_id


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
