"""The worst frames: which are shown, and what is drawn into them."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_accuracy import PERSON

from common.config.settings import Settings
from lab.accuracy import worst_frames
from lab.accuracy.accuracy import INDEX, Compared
from lab.accuracy.worst_frames import APART, TRACKED, TRUE, WorstFrame, stick, worst


def clip_of(off_mm: list[float]) -> Compared:
    """A clip in which every joint is as far off, from frame 9 on."""
    n = len(off_mm)
    true = np.tile(PERSON, (n, 1, 1))
    moved = true + 1e-3 * np.array(off_mm)[:, None, None] * [0.0, 0.0, 1.0]
    return Compared(np.arange(9, 9 + n), np.arange(n), moved, true, np.ones((n, 12)), n, 0, 0)


def test_neighbours_are_left_out_and_other_clips_are_not() -> None:
    off = [10.0] * 25
    off[5], off[6], off[16] = 80.0, 90.0, 70.0
    found = worst({"a": clip_of(off), "b": clip_of([85.0])}, most=3)
    assert [(one.clip, one.frame, round(one.mean_mm)) for one in found] == [
        ("a", 15, 90),
        ("b", 9, 85),
        ("a", 25, 70),
    ]


def test_the_joint_that_is_worst_is_named() -> None:
    clip = clip_of([10.0])
    clip.tracked_m[0, INDEX["r_ankle"], 1] += 0.3
    (one,) = worst({"a": clip})
    assert one.joint == "r_ankle"
    assert round(one.joint_mm) == 300


@given(
    st.dictionaries(
        st.sampled_from("abc"), st.lists(st.floats(0.0, 500.0), max_size=60), max_size=3
    ),
    st.integers(1, 12),
)
def test_what_is_shown_is_worse_than_all_that_is_not_beside_it(
    off_mm: dict[str, list[float]], most: int
) -> None:
    found = worst({name: clip_of(off) for name, off in off_mm.items()}, most)
    means = [one.mean_mm for one in found]
    assert means == sorted(means, reverse=True)
    for i, one in enumerate(found):
        for other in found[:i]:
            assert one.clip != other.clip or abs(one.frame - other.frame) >= APART
    for name, off in off_mm.items():
        for place, error in enumerate(off):
            beside = any(one.clip == name and abs(one.place - place) < APART for one in found)
            assert beside or (len(found) == most and error <= means[-1] + 1e-6)


def test_the_stick_joins_joints_at_pixel_centres() -> None:
    """A thigh from the centre of pixel (10, 5) to that of (10, 25); what is unknown is left out."""
    at_px = np.full((12, 2), np.nan)
    at_px[INDEX["l_hip"]], at_px[INDEX["l_knee"]] = (10.5, 5.5), (10.5, 25.5)
    picture = np.zeros((40, 40, 3), np.uint8)
    stick(picture, at_px, ((255, 0, 0), (0, 0, 255)))
    assert picture[15, 10].tolist() == [255, 0, 0]
    rows, columns = np.nonzero(picture.any(axis=2))
    assert columns.min() + columns.max() == 2 * 10
    assert not picture[:, :, 2].any()
    assert abs(int(rows.min()) + int(rows.max()) - (5 + 25)) <= 1


def test_a_joint_far_outside_draws_nothing() -> None:
    picture = np.zeros((40, 40, 3), np.uint8)
    stick(picture, np.full((12, 2), 1e12), ((255, 0, 0), (0, 0, 255)))
    assert not picture.any()


def frames_of(count: int) -> Any:
    """A video of 40 x 24 whose every picture says its number."""
    return lambda view, every, decoder: (
        SimpleNamespace(index=i, picture=np.full((24, 40, 3), 10 * i, np.uint8))
        for i in range(count)
    )


def view_of(number: int) -> Any:
    return SimpleNamespace(number=number, size=(40, 24))


def test_a_frame_is_taken_by_its_number_at_480_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a video that is shorter than the truth it is the last one."""
    monkeypatch.setattr(worst_frames, "recorded", frames_of(6))
    decoders: Any = SimpleNamespace(of={1: None, 2: None})
    for index, shown in ((0, 0), (4, 4), (9, 5)):
        picture, enlarged = worst_frames._taken(view_of(2), index, decoders)
        assert picture.shape == (480, 800, 3)
        assert (picture == 10 * shown).all()
        assert enlarged == 20.0


def drawn(monkeypatch: pytest.MonkeyPatch, rig: Any, truth: dict[str, Any]) -> tuple[Any, Any]:
    """The picture of place 1 of a clip whose compared rows are 2 and 4, and the sticks in it."""
    sticks: list[Any] = []
    noted: list[Any] = []
    clip = SimpleNamespace(views=(view_of(1), view_of(2)))

    def opened(settings: Settings, decoder: Any) -> Any:
        noted.append((settings.size, settings.clip, decoder))
        return clip

    monkeypatch.setattr(worst_frames, "open_clip", opened)
    monkeypatch.setattr(worst_frames, "whole_rig", lambda one: rig)
    monkeypatch.setattr(worst_frames, "recorded", frames_of(6))
    monkeypatch.setattr(worst_frames, "project", lambda camera, joints_m: camera * joints_m[:, :2])
    monkeypatch.setattr(
        worst_frames, "stick", lambda _, at_px, colours: sticks.append((at_px, colours))
    )
    true_m = np.arange(72.0).reshape(2, 12, 3)
    compared = Compared(
        np.array([7, 9]), np.array([2, 4]), true_m + 100, true_m, np.ones((2, 12)), 2, 0, 0
    )
    one = WorstFrame("a", 1, 9, 3.0, "l_hip", 4.0)
    decoders: Any = SimpleNamespace(of={1: "first", 2: "second"})
    picture = worst_frames._shown(one, compared, truth, Settings(clip="c", size="80x60"), decoders)
    assert noted == [("4096x4096", "c", "first")]
    return picture, (sticks, true_m[1])


def test_both_cameras_show_the_row_of_the_truth_and_true_sticks_lie_under_tracked_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Camera 2's third frame is row 5 of the truth, its second is row 4."""
    truth = {"present": np.ones(6), "frames_cam2": np.array([1, 4, 5])}
    rig = SimpleNamespace(cameras=(2.0, 3.0))
    picture, (sticks, true_m) = drawn(monkeypatch, rig, truth)
    assert picture.shape == (480, 1600, 3)
    assert (picture[0, 0, 0], picture[0, -1, 0]) == (40, 10)
    assert [colours for _, colours in sticks] == [TRUE, TRACKED] * 2
    for (at_px, _), (times, shift) in zip(
        sticks, ((2, 0), (2, 100), (3, 0), (3, 100)), strict=True
    ):
        assert at_px == pytest.approx(20.0 * times * (true_m[:, :2] + shift))


def test_a_clip_without_a_calibration_is_shown_without_sticks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture, (sticks, _) = drawn(monkeypatch, None, {"present": np.ones(6)})
    assert (picture[0, 0, 0], picture[0, -1, 0]) == (40, 40)
    assert not sticks


def test_pictures_are_numbered_from_the_worst_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted: list[Any] = []

    def shown(*given: Any) -> Any:
        noted.append(given)
        return np.full((4, 6, 3), 40 * len(noted), np.uint8)

    monkeypatch.setattr(worst_frames, "_shown", shown)
    frames = [
        WorstFrame("b", 1, 9, 30.0, "l_hip", 40.0),
        WorstFrame("a", 0, 2, 20.0, "l_knee", 25.0),
    ]
    clips, truths, settings = ({"a": f"{kind} of a", "b": f"{kind} of b"} for kind in "xyz")
    given: Any = (frames, clips, truths, settings, tmp_path, "decoders")
    told = worst_frames.draw(*given)
    assert [each["picture"] for each in told] == ["worst_01.png", "worst_02.png"]
    assert told[0] == {**frames[0]._asdict(), "picture": "worst_01.png"}
    assert noted == [
        (frames[0], "x of b", "y of b", "z of b", "decoders"),
        (frames[1], "x of a", "y of a", "z of a", "decoders"),
    ]
    for number in (1, 2):
        picture = cv2.imread(str(tmp_path / f"worst_0{number}.png"))
        assert picture is not None
        assert (picture == 40 * number).all()


def test_a_line_has_the_colour_of_the_side_that_it_ends_at() -> None:
    at_px = np.full((12, 2), np.nan)
    at_px[INDEX["l_hip"]], at_px[INDEX["r_hip"]] = (4.5, 20.5), (30.5, 20.5)
    at_px[INDEX["r_knee"]] = (30.5, 35.5)
    picture = np.zeros((40, 40, 3), np.uint8)
    stick(picture, at_px, ((255, 0, 0), (0, 0, 255)))
    assert picture[20, 15].tolist() == [0, 0, 255]
    assert picture[28, 30].tolist() == [0, 0, 255]
    assert not picture[:, :, 0].any()
