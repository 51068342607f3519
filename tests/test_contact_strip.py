"""Strips of a clip: both views, and limbs drawn where the person is."""

from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest

from lab.postures import contact_strip as module
from lab.postures.contact_strip import SHOWN, WIDTH_PX, contact_strip
from runtime.offline.lockstep import Decoders


@pytest.fixture(scope="module")
def strip(clip: Path) -> np.ndarray:
    with Decoders() as decoders:
        png = contact_strip(clip, None, decoders)
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR_RGB)
    assert picture is not None
    return np.asarray(picture)


@pytest.mark.slow
def test_a_strip_has_a_row_a_view(strip: np.ndarray) -> None:
    assert strip.shape == (2 * WIDTH_PX * 3 // 4, SHOWN * WIDTH_PX, 3)


def test_frames_differ_and_limbs_are_drawn_in_each(strip: np.ndarray) -> None:
    """The left limbs' colour is in every frame; somebody who moves looks different in the next."""
    frames = np.split(strip[: WIDTH_PX * 3 // 4], SHOWN, axis=1)
    for frame, following in pairwise(frames):
        assert np.abs(frame.astype(int) - following).mean() > 0.1
    for frame in frames:
        red, _, blue = (frame[..., i].astype(int) for i in range(3))
        assert np.abs(red - blue).max() > 60


def instants_of(*statuses: str) -> list[Any]:
    """What a tracker would pass on, each told by its number."""
    return [
        (dict.fromkeys((1, 2), number), {}, (SimpleNamespace(status=status, number=number),))
        for number, status in enumerate(statuses)
    ]


def chosen(monkeypatch: pytest.MonkeyPatch, statuses: list[str], window: int) -> list[list[int]]:
    """Which instants a strip shows, in either view; after a first pass that was given up."""
    settings = SimpleNamespace(recognizer=SimpleNamespace(window_frames=window))
    views = (SimpleNamespace(number=1), SimpleNamespace(number=2))

    def track(given: Any, decoders: Any, watch: Any) -> Any:
        assert (given, decoders) == (settings, "decoders")
        for now in instants_of("tracking"):
            watch.each(*now)
        watch.anew()
        for now in instants_of(*statuses):
            watch.each(*now)
        return SimpleNamespace(clip=SimpleNamespace(views=views))

    shown: dict[int, list[int]] = {1: [], 2: []}

    def showing(now: Any, number: int, rig: Any) -> Any:
        shown[number].append(now[2][0].number)
        return np.full((3, 4, 3), (10 * number, 20, 30), np.uint8)

    monkeypatch.setattr(module, "overridden", lambda *_: settings)
    monkeypatch.setattr("common.config.config_file.load", lambda path: path)
    monkeypatch.setattr(module, "whole_rig", lambda clip: "rig")
    monkeypatch.setattr(module, "Watch", lambda each, anew: SimpleNamespace(each=each, anew=anew))
    monkeypatch.setattr(module, "track_clip", track)
    monkeypatch.setattr(module, "_shown", showing)
    png = contact_strip(Path("clip"), None, "decoders")  # type: ignore[arg-type]
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR_RGB)
    assert picture is not None
    assert picture[0, 0].tolist() == [10, 20, 30]
    assert picture[-1, -1].tolist() == [20, 20, 30]
    return [shown[1], shown[2]]


def test_a_strip_shows_the_last_window_of_the_motion_from_end_to_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 30 frames 5 to 24 move; of these the last 15 are 10 to 24, of which 8 are shown."""
    statuses = ["empty"] * 5 + ["tracking", "predicted"] * 10 + ["lost"] * 5
    due = [10, 12, 14, 16, 18, 20, 22, 24]
    assert chosen(monkeypatch, statuses, 15) == [due, due]


def test_a_clip_in_which_nobody_moves_is_shown_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    assert chosen(monkeypatch, ["empty"] * 8, 40) == [list(range(8))] * 2


def test_a_view_without_a_frame_is_black_and_limbs_are_drawn_where_a_rig_is_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawn: list[Any] = []
    picture = np.full((120, 80, 3), 0x5F, np.uint8)
    monkeypatch.setattr(module, "inset", lambda report, seen: picture.copy())
    monkeypatch.setattr(module, "figure", lambda body: body)
    monkeypatch.setattr(module, "limb_ends", lambda body: body)
    monkeypatch.setattr(module, "limb_contours", lambda camera, ends: (camera, ends))
    monkeypatch.setattr(module, "draw_contours", lambda image, *given: drawn.append(given))
    frame, report = SimpleNamespace(picture=picture), SimpleNamespace(width=80)
    rig: Any = SimpleNamespace(cameras=("first", "second"))
    both: Any = ({1: frame, 2: frame}, {1: report, 2: report}, ("body",))
    image = module._shown(both, 2, rig)
    assert image.shape == (240, WIDTH_PX, 3)
    assert (image == 0x50).all(), "small differences of colour are left out"
    assert drawn == [(("second", "body"), 80)]
    alone: Any = ({1: frame}, {1: report}, ("body",))
    assert not module._shown(alone, 2, rig).any()
    module._shown(both, 1, None)
    nobody: Any = ({1: frame}, {1: report}, (None,))
    module._shown(nobody, 1, rig)
    assert len(drawn) == 1
