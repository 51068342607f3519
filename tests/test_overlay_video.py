"""The overlay's film lasts as long as the one that was followed, whatever that one's rate does;
the body beside it stands as it stood."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from animator.overlay import SHOWN
from common.config.picture_size import size_within
from common.rig.camera import Camera, Matrix
from common.video.pictures import Wanted
from runtime.offline.video_tracking import Followed
from tritrack.single import overlay_video
from tritrack.single.overlay_video import STANDS_S, shown_times


@pytest.mark.parametrize("rate_hz", [15.0, 24_000 / 1001, 25.0, 30.0, 59.94])
def test_each_picture_of_a_steady_film_is_shown_once(rate_hz: float) -> None:
    time_s = np.arange(2000) / rate_hz
    assert (shown_times(time_s, 1 / rate_hz) == 1).all()


def test_a_picture_stands_until_the_next_was_taken() -> None:
    """By hand, at ten a second: the second picture stands for 0.3 s, the third is left out."""
    assert shown_times(np.array([0.0, 0.1, 0.4, 0.41, 0.5]), 0.1).tolist() == [1, 3, 0, 1, 1]


def test_a_film_whose_rate_varies_keeps_its_duration() -> None:
    gaps_s = np.random.default_rng(3).choice([1, 1, 1, 2, 4], 500) / 30
    time_s = np.concatenate([[0.0], np.cumsum(gaps_s)])
    assert shown_times(time_s, 1 / 30).sum() == pytest.approx(30 * time_s[-1] + 1)


def test_an_hour_without_a_picture_is_not_drawn() -> None:
    assert shown_times(np.array([0.0, 0.1, 3600.0]), 0.1).tolist() == [1, round(STANDS_S * 10), 1]


def test_one_frame_is_a_film() -> None:
    assert shown_times(np.array([2.5]), 0.1).tolist() == [1]


SINE, COSINE = 0.6, 0.8
DOWN: Matrix = ((1.0, 0.0, 0.0), (0.0, -COSINE, SINE), (0.0, -SINE, -COSINE))
"""World to a camera on +z that looks down by 37 degrees."""
ASIDE: Matrix = ((0.0, 0.0, -1.0), (-SINE, -COSINE, 0.0), (-COSINE, SINE, 0.0))
"""To one on +x that looks up so far."""


@pytest.mark.parametrize(("R", "towards"), [(DOWN, (0.0, 0.0, 1.0)), (ASIDE, (1.0, 0.0, 0.0))])
def test_who_stands_upright_before_a_camera_that_looks_down_or_up_is_drawn_upright(
    R: Matrix, towards: tuple[float, float, float]
) -> None:
    assert np.linalg.det(np.array(R)) == pytest.approx(1.0)
    camera = Camera("cam1", DOWN, R, (0.0, 0.0, 5.0))
    film = Followed([], [], 1 / 15, camera, None, None, {})
    shown = film.to_camera(np.array([(0.0, 0.0, 0.0), (0.0, 1.7, 0.0), towards]))
    assert shown == pytest.approx(np.array([(0, 0, 0), (0, 1.7, 0), (0, 0, 1)]), abs=1e-12)


def body_of(frame: int, **parts: Any) -> Any:
    given = {"joints_m": (), "joints_px": (), "confidence": (), "status": "empty"}
    return SimpleNamespace(**{**given, "frame": frame, "captured_s": 0.5 * frame, **parts})


def report_of(captured_s: float) -> Any:
    return SimpleNamespace(captured_s=captured_s, width=160, upright=None)


def drawing(monkeypatch: pytest.MonkeyPatch) -> Any:
    """What each frame is drawn from."""
    noted: Any = []
    monkeypatch.setattr(overlay_video, "overlay", lambda *given: noted.append(given) or given[0])
    monkeypatch.setattr(overlay_video, "mask_of", lambda report: f"silhouette {report.captured_s}")
    monkeypatch.setattr(
        overlay_video, "as_worked_on", lambda joints_px, _: joints_px + np.array([1.0, 2.0])
    )
    return noted


def test_joints_are_drawn_in_the_pictures_own_pixels_and_the_caption_tells_the_frame(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A picture of four times the width that was worked at."""
    noted = drawing(monkeypatch)
    found: Any = SimpleNamespace(to_camera=lambda joints_m: 10 * joints_m)
    joints_px, joints_m = np.arange(30.0).reshape(15, 2), np.arange(45.0).reshape(15, 3)
    body = body_of(
        7,
        joints_px=(joints_px.tolist(), None),
        joints_m=joints_m.tolist(),
        confidence=[0.25] * 5 + [0.75] * 10,
        status="tracking",
    )
    picture = np.zeros((480, 640, 3), np.uint8)
    overlay_video._drawn(found, report_of(0.5), body, picture)
    overlay_video._drawn(found, report_of(0.6), body_of(8), picture)
    (_, silhouette, px, m, confidence, caption), (_, _, no_px, no_m, no_sure, other) = noted
    assert silhouette == "silhouette 0.5"
    assert px == pytest.approx(4 * (joints_px + np.array([1.0, 2.0])))
    assert m == pytest.approx(10 * joints_m)
    assert confidence.tolist() == list(body.confidence)
    assert caption == "7  3.50 s  tracking  0.58"
    assert np.isnan(no_px).all()
    assert no_px.shape == (15, 2)
    assert np.isnan(no_m).all()
    assert no_m.shape == (15, 3)
    assert no_sure.tolist() == [0.0] * 15
    assert other == "8  4.00 s  empty"


@pytest.mark.parametrize(
    ("times_s", "rate_hz", "shown"),
    [([0.0, 0.1, 0.2, 0.5], 10.0, "aabbccd"), ([2.0], 1 / 0.3, "a")],
)
def test_the_film_shows_each_picture_as_long_as_it_stood_and_says_how_far_it_is(
    monkeypatch: pytest.MonkeyPatch, times_s: list[float], rate_hz: float, shown: str
) -> None:
    """The usual gap is that of the film; of one picture the clip's own period is."""
    told: list[float] = []
    pictures = "abcd"[: len(times_s)]
    monkeypatch.setattr(overlay_video, "overlaid", lambda found, decoder: iter(pictures))
    monkeypatch.setattr(
        overlay_video, "shown_times", lambda time_s, _: [2] * (len(time_s) - 1) + [1]
    )
    monkeypatch.setattr(
        overlay_video, "write_video", lambda path, drawn, rate: (path, [*drawn], rate)
    )
    found: Any = SimpleNamespace(reports=[report_of(each) for each in times_s], period_s=0.3)
    decoder: Any = None
    written: Any = overlay_video.write_overlay(found, Path("out"), decoder, told.append)
    path, drawn, rate = written
    assert (path, "".join(drawn), rate) == (Path("out"), shown, pytest.approx(rate_hz))
    assert told == [(n + 1) / len(times_s) for n in range(len(times_s))]


def test_masks_are_drawn_on_paper_and_clips_on_their_own_frames_upright(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    of_masks: Any = SimpleNamespace(clip=None, size=(40, 30), reports=[1, 2, 3])
    asked: list[Any] = []

    def frames(*given: Any) -> Any:
        asked.append(given)
        return iter([SimpleNamespace(picture=n) for n in range(2)])

    decoder: Any = SimpleNamespace(frames=frames)
    papers = list(overlay_video._pictures(of_masks, decoder))
    assert [paper.shape for paper in papers] == [(30, 40, 3)] * 3
    assert all((paper == 255).all() for paper in papers)
    view = SimpleNamespace(source="a.mp4", upright_source=(720, 1280), quarters=3)
    of_clip: Any = SimpleNamespace(clip=SimpleNamespace(views=(view, None), every=2))
    assert list(overlay_video._pictures(of_clip, decoder)) == [0, 1]
    size = size_within((720, 1280), SHOWN)
    assert asked == [("a.mp4", size, Wanted(2, quarters=3))]
