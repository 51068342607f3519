"""Several people in a whole picture: detected in their places, at any size."""

from collections.abc import Callable
from typing import Any

import numpy as np
import onnxruntime
import pytest
from crowds import corners, crowd, whole_people
from test_own_landmarks import acted

from common.video.pictures import Image
from viewer.landmarks.landmark_looks import opened
from viewer.people import people_detector
from viewer.people.people_detector import Detection, overlap, people_in


def shares(detected: list[Detection], *true: np.ndarray) -> list[float]:
    """Of each true box the largest overlap with a detection."""
    return [max((overlap(each, one.corners_px) for one in detected), default=0.0) for each in true]


def recall(tall: int, seed: int) -> float:
    """Of 40 people, two in each picture."""
    people, found = whole_people(seed, 40), list[float]()
    for at in range(0, 40, 2):
        made = crowd(people[at : at + 2], [(80, 230, tall), (240, 230, tall)], at)
        found += shares(people_in(made.picture), *map(corners, made.masks))
    return float(np.mean(np.array(found) > 0.35))


@pytest.mark.slow
@pytest.mark.parametrize(("tall", "least"), [(30, 0.5), (45, 0.65), (80, 0.8), (160, 0.9)])
def test_people_of_any_size_are_detected(tall: int, least: float) -> None:
    """From an eighth of the picture's height on; half of their poses have no order."""
    assert recall(tall, 61_500) >= least


def test_bytes_are_multiplied_as_exactly_as_floats() -> None:
    """On processors without VNNI sums of bytes' products saturate unless that is forbidden: a
    person's peak was at -20 for 2."""
    shot, *_ = acted()
    picture = people_detector._shown(shot.frames[0], 320 / people_detector.LONG_PX)
    options = onnxruntime.SessionOptions()
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_BASIC
    plain = onnxruntime.InferenceSession(people_detector.NETWORK, options)
    exact, *_ = plain.run(None, {"picture": picture})
    heat, *_ = opened(people_detector.NETWORK).run(None, {"picture": picture})
    assert exact.max() > 0.0
    assert heat.max() == pytest.approx(exact.max(), abs=0.5)


def test_two_people_are_two_detections_and_an_empty_room_is_none() -> None:
    shot, joints_px, _, empty = acted()
    beside = np.concatenate([shot.frames[0][:, 70:250], shot.frames[0][:, 70:250]], axis=1)
    detected = people_in(beside)
    box = np.stack([joints_px.min(axis=0), joints_px.max(axis=0)]) - (70.0, 0.0)
    assert len(detected) == 2
    assert min(shares(detected, box, box + np.array([180.0, 0.0]))) > 0.6
    assert people_in(empty) == []


def test_in_a_part_of_the_picture_are_those_who_are_whole_in_it_at_the_same_places() -> None:
    shot, *_ = acted()
    shown = shot.frames[0][:, 70:250]
    beside = np.concatenate([shown, shown], axis=1)
    both = sorted(people_in(beside), key=lambda each: each.corners_px[0, 0])
    for person in both:
        low, high = person.corners_px
        (found,) = people_in(beside, np.stack((low - 30.0, high + 30.0)))
        assert overlap(found.corners_px, person.corners_px) > 0.8
        assert np.median(np.linalg.norm(found.joints_px - person.joints_px, axis=1)) < 6.0
    (low, high), cut = both[0].corners_px, both[1].corners_px[0, 0] + 30.0
    (left,) = people_in(beside, np.array([low - 30.0, (cut, high[1] + 30.0)]))
    assert overlap(left.corners_px, both[0].corners_px) > 0.8, "the other one is cut"
    assert len(people_in(beside, np.array([(-50.0, -50.0), (900.0, 900.0)]))) == 2


@pytest.mark.parametrize(
    ("part", "start", "end"),
    [
        ([(100.0, 50.0), (150.0, 150.0)], (85, 40), (165, 160)),
        ([(300.0, 100.0), (330.0, 140.0)], (280, 100), (320, 140)),
        ([(-9.0, -9.0), (900.0, 900.0)], (0, 0), (320, 240)),
    ],
    ids=["within", "at the right end", "more than all"],
)
def test_a_part_is_whole_units_within_the_picture(
    part: list[tuple[float, float]], start: tuple[int, int], end: tuple[int, int]
) -> None:
    found = people_detector._whole_units(np.array(part), 40.0, (240, 320, 3))
    assert [each.tolist() for each in found] == [list(start), list(end)]


@pytest.mark.parametrize(
    "changed",
    [lambda picture: picture[::2, ::2], lambda picture: picture.repeat(2, 0).repeat(2, 1)],
)
def test_places_are_the_pictures_own_pixels_at_any_size(
    changed: Callable[[Image], Image],
) -> None:
    picture = acted()[0].frames[0]
    other = changed(picture)
    (first,), (second,) = people_in(picture), people_in(other)
    scale = len(other) / len(picture)
    assert overlap(first.corners_px * scale, second.corners_px) > 0.8
    off_px = np.linalg.norm(first.joints_px * scale - second.joints_px, axis=1)
    assert np.median(off_px) < 6.0 * scale


def test_a_window_is_upright_about_the_box_and_turned_with_a_trunk_that_leans() -> None:
    joints = np.zeros((17, 2))
    joints[[5, 6]], joints[[11, 12]] = (100.0, 50.0), (100.0, 90.0)
    box = np.array([(80.0, 30.0), (120.0, 150.0)])
    assert Detection(0.5, box, joints).window == (25, 15, 150, 0.0)
    joints[[5, 6]] = (140.0, 90.0)  # the head to the right
    assert Detection(0.5, box, joints).window.turn_deg == pytest.approx(90.0)


def test_boxes_overlap_by_their_common_share() -> None:
    box = np.array([(0.0, 0.0), (4.0, 2.0)])
    assert overlap(box, box) == 1.0
    assert overlap(box, box + np.array([2.0, 0.0])) == pytest.approx(1 / 3)
    assert overlap(box, box + np.array([4.0, 0.0])) == 0.0
    assert overlap(box * 0.0, box * 0.0) == 0.0


class OnePeak:
    """Stands in for the network: a person in row 10, column 20 of 48x64 cells of 5 pixels."""

    def run(self, _: None, given: dict[str, Any]) -> list[np.ndarray]:
        assert given["picture"].shape == (1, 192, 256, 3)
        centre = np.full((1, 1, 48, 64), -9.0, np.float32)
        size, offset = (np.zeros((1, 2, 48, 64), np.float32) for _ in range(2))
        joints = np.zeros((1, 34, 48, 64), np.float32)
        centre[0, 0, 10, 20] = 3.0
        size[0, :, 10, 20], offset[0, :, 10, 20] = (8.0, 4.0), (0.5, 0.25)
        joints[0, ::2, 10, 20], joints[0, 1::2, 10, 20] = np.arange(17) * 0.5, -np.arange(17) * 0.25
        return [centre, size, offset, joints]


def test_a_peak_is_a_box_about_its_cell_and_joints_away_from_it_rows_before_columns(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(people_detector, "opened", lambda _: OnePeak())
    (found,) = people_in(np.zeros((240, 320, 3), np.uint8))
    assert found.score == pytest.approx(1.0 / (1.0 + np.exp(-3.0)))
    assert found.corners_px.tolist() == [[91.25, 32.5], [111.25, 72.5]]
    away = np.arange(17)[:, None] * (-1.25, 2.5)
    assert found.joints_px == pytest.approx(np.array((100.0, 50.0)) + away)


def test_a_standing_persons_joints_are_from_the_head_down() -> None:
    """By the network as shipped: nose, shoulders, hips, knees, ankles."""
    (found,) = people_in(acted()[0].frames[0])
    rows = [found.joints_px[part, 1].mean() for part in ([0], [5, 6], [11, 12], [13, 14], [15, 16])]
    assert rows == sorted(rows)
    assert np.ptp(rows) > 0.6 * np.ptp(found.corners_px[:, 1])
