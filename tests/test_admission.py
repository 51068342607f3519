"""What a live run is refused for before any process starts, and what it then works with."""

import io
from typing import Any

import msgspec
import pytest
from rich.console import Console
from typed import instead

from common.config.part_settings import BusSettings, CameraSettings
from common.config.settings import Settings
from common.rig.camera import paper_rig
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.clip_sources import ClipError
from runtime.live import admission
from runtime.live.admission import LiveRefused, admitted, opened

RIG = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0))
CAMERAS = Settings(cameras={"cam1": CameraSettings(device=0)})


@pytest.mark.parametrize("record", [True, False])
def test_what_is_left_open_is_chosen_and_said_after_all_was_looked_at(
    monkeypatch: pytest.MonkeyPatch, record: bool
) -> None:
    library = instead(monkeypatch, "runtime.live.admission.refuse_without_library")
    held = instead(monkeypatch, "runtime.live.admission.refuse_held_ports")
    console = Console(record=True, width=200, file=io.StringIO())
    asked = msgspec.structs.replace(CAMERAS, bus=BusSettings(endpoint="auto"))
    found = admitted(asked, record, console)
    assert len(library.given) == record
    assert held.last[0].bus.endpoint == found.bus.endpoint != "auto"
    assert found.bus.session
    assert f"the bus: {found.bus.endpoint}" in console.export_text()
    quiet = Console(record=True, width=200, file=io.StringIO())
    admitted(msgspec.structs.replace(CAMERAS, bus=BusSettings("tcp/127.0.0.1:1")), record, quiet)
    assert quiet.export_text() == ""


def test_the_theses_mode_is_no_live_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    held = instead(monkeypatch, "runtime.live.admission.refuse_held_ports")
    with pytest.raises(LiveRefused, match="tritrack single VIDEO --mode thesis"):
        admitted(msgspec.structs.replace(CAMERAS, mode="thesis"), False, Console(quiet=True))
    assert not held.given


@pytest.mark.parametrize(("posture_id", "meant"), [(3, "squat"), (admission.NO_POSTURE, "")])
def test_a_clip_gets_a_camera_for_each_viewer_and_the_lengths_that_are_known(
    monkeypatch: pytest.MonkeyPatch, posture_id: int, meant: str
) -> None:
    """A clip of free motion is of no posture that a model would have to know."""
    view = ClipView(2, 1, (160, 120), (160, 120), 15.0, 0)
    rig = msgspec.structs.replace(RIG, cameras=RIG.cameras[1:])
    meta = msgspec.structs.replace(Meta(), posture="squat", posture_id=posture_id)
    instead(monkeypatch, "common.video.clips.open_clip", Clip("own", (view,), 1, rig, meta))
    lengths: Any = object()
    instead(monkeypatch, "runtime.offline.lockstep.measured_before", lengths)
    model = instead(monkeypatch, "recognizer.__main__.model_of")
    source = instead(monkeypatch, "viewer.landmarks.landmark_sources.refuse_landmarks")
    clip = opened(CAMERAS, "")
    assert (clip.name, clip.body) == ("own", lengths)
    assert clip.rig is not None
    assert clip.rig.cameras == (RIG.cameras[1],) * 2
    assert model.last == (CAMERAS, meant)
    assert source.last == (CAMERAS, (view,))
    assert opened(CAMERAS, "monday").name == "monday"


def test_three_cameras_without_a_calibration_or_for_the_paper_are_refused_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    views = tuple(ClipView(n, n, (160, 120), (160, 120), 15.0, 0) for n in (1, 2, 3))
    clip = Clip("own", views, 1, None, Meta())
    instead(monkeypatch, "common.video.clips.open_clip", clip)
    with pytest.raises(ClipError, match="3 cameras need a calibration"):
        opened(CAMERAS, "")
    rig = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    known = msgspec.structs.replace(clip, rig=rig)
    instead(monkeypatch, "common.video.clips.open_clip", known)
    with pytest.raises(ClipError, match="the paper's mode is for two cameras"):
        opened(msgspec.structs.replace(CAMERAS, mode="paper"), "")
