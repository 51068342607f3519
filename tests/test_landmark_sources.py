"""Which source a run's settings name, and that a live viewer tells what a recorded one does."""

import json
import threading
import time
from pathlib import Path

import msgspec
import numpy as np
import pytest
from fake_mediapipe import install_fake
from local_bus import LocalBus

from common.body.observation import Landmarks
from common.bus.messages import View
from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.method import DEFAULT
from common.video.clip_facts import ClipView
from common.video.clips import open_clip
from common.video.decoding import Decoder
from runtime.offline.frame_pairs import instants
from viewer import __main__ as viewer
from viewer import track
from viewer.background.background import learn
from viewer.capture import Live, RoomClock, recorded
from viewer.landmarks.keypoint_files import KeypointFiles
from viewer.landmarks.landmark_looks import SHIPPED
from viewer.landmarks.landmark_sources import oddities, outside_sources, refuse_landmarks
from viewer.landmarks.mediapipe_source import MediaPipe


def landmarks_of(view: View) -> Landmarks | None:
    return None if view.person is None else view.person.landmarks


def keypoints(folder: Path, frames: int) -> Path:
    """Of one person, who walks a pixel a frame, in both views."""
    for camera in (1, 2):
        (folder / f"cam{camera}").mkdir(parents=True)
        for n in range(frames):
            points = [
                coordinate for _ in range(17) for coordinate in (20.0 * camera + n, 30.0, 0.8)
            ]
            told = {"people": [{"pose_keypoints_2d": points}]}
            (folder / f"cam{camera}" / f"{n:04d}_keypoints.json").write_text(json.dumps(told))
    return folder


def views_of(settings: Settings) -> tuple[ClipView, ...]:
    return open_clip(settings).views


@pytest.mark.parametrize("word", ["own", "none"])
def test_our_own_and_none_ask_nobody_outside(clip: Path, word: str) -> None:
    settings = Settings(clip=str(clip), landmarks=word)
    with outside_sources(settings, views_of(settings)) as sources:
        assert sources == {}


def test_a_folder_is_read_for_every_view(clip: Path, tmp_path: Path) -> None:
    settings = Settings(clip=str(clip), landmarks=str(keypoints(tmp_path, 3)))
    with outside_sources(settings, views_of(settings)) as sources:
        assert {number: type(source) for number, source in sources.items()} == {
            1: KeypointFiles,
            2: KeypointFiles,
        }
        assert [line.split()[-5:] for line in oddities(sources)] == [
            ["after", "3", "of", str(view.frames), "frames"] for view in views_of(settings)
        ]


def test_mediapipe_looks_at_every_view_and_ends_with_the_run(
    clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path)
    settings = Settings(clip=str(clip), landmarks="mediapipe")
    with outside_sources(settings, views_of(settings)) as sources:
        assert {type(source) for source in sources.values()} == {MediaPipe}
        assert sorted(sources) == [1, 2]


def test_what_a_run_would_fail_on_is_said_before_it(
    clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("viewer.landmarks.mediapipe_source.find_spec", lambda _: None)
    settings = Settings(clip=str(clip), landmarks="mediapipe")
    with pytest.raises(SettingsError, match="needs MediaPipe: pip install"):
        refuse_landmarks(settings, views_of(settings))
    empty = msgspec.structs.replace(settings, landmarks=str(tmp_path))
    with pytest.raises(SettingsError, match="no keypoint files of camera 1"):
        refuse_landmarks(empty, views_of(settings))
    refuse_landmarks(msgspec.structs.replace(settings, landmarks="none"), views_of(settings))


def test_both_views_of_an_instant_have_their_own_landmarks(clip: Path, tmp_path: Path) -> None:
    settings = Settings(clip=str(clip), landmarks=str(keypoints(tmp_path, 100)))
    whole = open_clip(settings)
    with (
        outside_sources(settings, whole.views) as sources,
        Decoder() as one,
        Decoder() as other,
    ):
        for frames in instants(whole, {1: one, 2: other}, sources):
            for number, frame in frames.items():
                (person,) = frame.landmarks
                assert person.joints_px[5] == pytest.approx(
                    (20.0 * number + frame.index + 0.5, 30.5)
                )


@pytest.mark.slow
def test_a_live_viewer_reports_the_landmarks_that_a_recorded_one_does(
    clip: Path, tmp_path: Path
) -> None:
    settings = Settings(clip=str(clip), landmarks=str(keypoints(tmp_path, 100)))
    view = msgspec.structs.replace(views_of(settings)[0], fps=30.0)
    setup = track.Setup(1, None, settings, DEFAULT)
    state = track.init(setup, learn([np.zeros((120, 160, 3), np.uint8)]))
    bus = LocalBus()
    reports = bus.subscribe(View)
    with outside_sources(settings, (view,)) as sources, Decoder() as decoder:
        offline = {
            frame.index: landmarks_of(track.look(state, frame, None)[1])
            for frame in recorded(view, 1, decoder, sources[1])
        }
        with Live(view, 1, RoomClock(time.monotonic() + 0.3), sources[1]) as live:
            viewer.run(viewer.Prepared(view, state), live, bus, threading.Event())
    came = {report.frame: landmarks_of(report) for report in reports.drain()}
    assert came
    assert None not in came.values()
    assert all(landmarks == offline[index] for index, landmarks in came.items())


def test_a_network_of_ones_own_looks_in_the_viewer_and_no_other_file_does(
    clip: Path, tmp_path: Path
) -> None:
    own = tmp_path / "own.onnx"
    own.write_bytes(SHIPPED.read_bytes())
    settings = Settings(clip=str(clip), landmarks=str(own))
    refuse_landmarks(settings, views_of(settings))
    with outside_sources(settings, views_of(settings)) as sources:
        assert sources == {}
    other = msgspec.structs.replace(settings, landmarks=str(tmp_path / "other.onnx"))
    (tmp_path / "other.onnx").write_bytes(b"no network")
    with pytest.raises(SettingsError, match=r"other\.onnx is no network"):
        refuse_landmarks(other, views_of(other))
