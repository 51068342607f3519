"""Keypoints from files, as OpenPose writes them: whose and where they are, what is refused."""

import json
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.extremities import EXTREMITY_NAMES
from common.body.observation import Landmarks
from common.config.part_settings import SettingsError
from common.video.clip_facts import ClipView
from common.video.pictures import Decoded
from viewer.landmarks.keypoint_files import (
    MOST_BYTES,
    KeypointFiles,
    _folder_of,
    _with_a_whole_head,
    numbered,
    people_of,
)
from viewer.landmarks.keypoint_layouts import BODY_POINTS, POINT

WRIST = JOINT_NAMES.index("l_wrist")


def person(points: int = 17, at: tuple[float, float] = (10.0, 20.0), score: float = 0.5) -> object:
    """All of whose points lie at one place."""
    return {"pose_keypoints_2d": [*at, score] * points}


def written(path: Path, *people: object) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"version": 1.3, "people": people}))
    return path


def view_of(source: str | int = "walk.avi", frames: int = 3) -> ClipView:
    return ClipView(1, source, (320, 240), (160, 120), 15.0, frames)


def told(source: KeypointFiles, index: int) -> tuple[Landmarks, ...]:
    picture = np.zeros((120, 160, 3), np.uint8)
    return source.people(Decoded(index, 0.0, picture), 1.0)


@pytest.mark.parametrize("points", [17, 18, 25, 26])
def test_a_point_is_told_in_the_working_pictures_pixels_by_our_convention(
    tmp_path: Path, points: int
) -> None:
    """Their pixel (0, 0) is a pixel's centre, ours is (0.5, 0.5); the picture is half as large."""
    for n, at in enumerate([(0.0, 0.0), (319.0, 239.0), (99.5, 9.5)]):
        written(tmp_path / "cam1" / f"take_{n:012d}_keypoints.json", person(points, at))
    source = KeypointFiles(tmp_path, view_of(), alone=False)
    places = [told(source, n)[0].joints_px[WRIST] for n in range(3)]
    assert places == [(0.25, 0.25), (159.75, 119.75), (50.0, 5.0)]
    assert told(source, 0)[0].confidence == (0.5,) * len(JOINT_NAMES)
    assert source.odd == ()


@pytest.mark.parametrize("place", ["cam1", "walk_json", ""])
def test_a_views_files_lie_where_they_are_told_to(tmp_path: Path, place: str) -> None:
    written(tmp_path / place / "0.json", person())
    assert told(KeypointFiles(tmp_path, view_of(), alone=True), 0)


def test_of_two_views_none_owns_the_folder_itself(tmp_path: Path) -> None:
    written(tmp_path / "0.json", person())
    with pytest.raises(SettingsError, match=r"no keypoint files of camera 1.*cam1 or .*walk_json"):
        KeypointFiles(tmp_path, view_of(), alone=False)


def test_a_name_ends_in_its_frame_counted_from_0_or_from_1(tmp_path: Path) -> None:
    zero = [tmp_path / "a" / name for name in ("x_0.json", "x_2_keypoints.json", "x_10.json")]
    one = [tmp_path / "b" / f"take2_{n:06d}.json" for n in (1, 2, 3)]
    for path in (*zero, *one):
        written(path)
    assert numbered(tmp_path / "a") == {0: zero[0], 2: zero[1], 10: zero[2]}
    assert numbered(tmp_path / "b") == {0: one[0], 1: one[1], 2: one[2]}


def test_everybody_is_told_and_a_frame_without_a_file_shows_nobody(tmp_path: Path) -> None:
    written(tmp_path / "cam1" / "0.json", person(), person(at=(50.0, 60.0)))
    written(tmp_path / "cam1" / "2.json")
    source = KeypointFiles(tmp_path, view_of(), alone=False)
    assert [len(told(source, n)) for n in (0, 1, 2, 7)] == [2, 0, 0, 0]


def test_whose_points_all_have_no_score_is_nobody(tmp_path: Path) -> None:
    assert people_of(written(tmp_path / "0.json", person(score=0.0))) == []


def test_scores_beyond_1_are_certainty(tmp_path: Path) -> None:
    (one,) = people_of(written(tmp_path / "0.json", person(score=1.3)))
    assert set(one[:17, 2]) == {1.0}


def points_of(**given: tuple[float, float, float]) -> object:
    """A person with these points of BODY_POINTS; the others are not seen."""
    numbers = [given.get(name, (0.0, 0.0, 0.0)) for name in BODY_POINTS]
    return {"pose_keypoints_2d": [number for point in numbers for number in point]}


def test_in_profile_one_ear_tells_the_head(tmp_path: Path) -> None:
    shoulders = {f"{side}_shoulder": (100.0, 100.0, 0.9) for side in "lr"}
    hips = {f"{side}_hip": (100.0, 150.0, 0.9) for side in "lr"}
    seen = points_of(r_ear=(100.0, 80.0, 0.7), nose=(108.0, 82.0, 0.8), **shoulders, **hips)
    written(tmp_path / "cam1" / "0.json", seen)
    (one,) = told(KeypointFiles(tmp_path, view_of(frames=1), alone=False), 0)
    top = JOINT_NAMES.index("head_top")
    assert one.confidence[top] == pytest.approx(0.7)
    assert one.joints_px[top][0] == pytest.approx(50.0, abs=2.0)
    assert 25.0 < one.joints_px[top][1] < 38.0


def test_files_that_end_before_the_film_are_told(tmp_path: Path) -> None:
    written(tmp_path / "cam1" / "0.json", person())
    odd = KeypointFiles(tmp_path, view_of(frames=3), alone=False).odd
    assert odd == (f"{tmp_path / 'cam1'} ends after 1 of 3 frames",)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("", "no keypoint file"),
        ("no json", "no keypoint file"),
        ("[]", "no keypoint file"),
        ('{"people": [{}]}', "pose_keypoints_2d"),
        ('{"people": [{"pose_keypoints_2d": ["a"]}]}', "no keypoint file"),
        ('{"people": [{"pose_keypoints_2d": [1, 2]}]}', "a person of 2 numbers"),
        (json.dumps({"people": [person(19)]}), "a person of 57 numbers.*BODY_25, COCO"),
        (json.dumps({"people": [person(at=(1e9, 0.0))]}), "nowhere near a picture"),
        ('{"people": [' + "[" * 5000, "no keypoint file"),
        (json.dumps({"people": [person()] * 101}), "101 people"),
        (" " * (MOST_BYTES + 1), "bytes"),
    ],
)
def test_what_is_no_keypoint_file_is_refused_in_one_line_with_its_name(
    tmp_path: Path, content: str, why: str
) -> None:
    path = tmp_path / "cam1" / "take_07_keypoints.json"
    path.parent.mkdir()
    path.write_text(content)
    with pytest.raises(SettingsError, match=rf"^[^\n]*take_07_keypoints\.json[^\n]*{why}[^\n]*$"):
        KeypointFiles(tmp_path, view_of(), alone=False)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "0.json"
    path.write_bytes(b'{"people": [\xff\xfe]}')
    with pytest.raises(SettingsError, match=r"0\.json is no keypoint file"):
        people_of(path)


@pytest.mark.parametrize(
    ("names", "why"),
    [(["people.json"], "names no frame"), (["a_1.json", "b_01.json"], "are of one frame")],
)
def test_a_name_that_tells_no_frame_of_its_own_is_refused(
    tmp_path: Path, names: Sequence[str], why: str
) -> None:
    for name in names:
        written(tmp_path / name)
    with pytest.raises(SettingsError, match=why):
        numbered(tmp_path)


def test_a_camera_has_no_files(tmp_path: Path) -> None:
    written(tmp_path / "cam1" / "0.json", person())
    with pytest.raises(SettingsError, match="for recorded clips: camera 1 is none"):
        KeypointFiles(tmp_path, view_of(source=0), alone=False)


def test_feet_and_nose_are_told_where_a_layout_has_them(tmp_path: Path) -> None:
    """BODY_25: 0 the nose, 19 and 21 the left big toe and heel, 22 and 24 the right ones'."""
    numbers = [[float(n), 2.0 * n, 0.5] for n in range(25)]
    keypoints = {"pose_keypoints_2d": [number for point in numbers for number in point]}
    written(tmp_path / "cam1" / "0.json", keypoints)
    (shown,) = told(KeypointFiles(tmp_path, view_of(), alone=True), 0)
    by_name = dict(zip(EXTREMITY_NAMES, shown.extremities_px, strict=True))
    points = {"nose": 0, "l_toe": 19, "l_heel": 21, "r_toe": 22, "r_heel": 24}
    for name, point in points.items():  # their pixels' middles, at half the size
        assert by_name[name] == ((point + 0.5) / 2, (2 * point + 0.5) / 2)
    sure = dict(zip(EXTREMITY_NAMES, shown.extremities_confidence, strict=True))
    assert {name for name, share in sure.items() if share} == set(points)


def test_a_folder_without_keypoint_files_is_said_to_be_one(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="no keypoint files"):
        numbered(tmp_path)


@pytest.mark.parametrize("side", ["l", "r"])
def test_a_hidden_ear_is_where_the_other_is_and_a_hidden_nose_between_the_ears(side: str) -> None:
    """By hand: a score of 0 alone is hidden, and a nose that is seen stays."""
    other = "r" if side == "l" else "l"
    nose, own, far = (POINT[name] for name in ("nose", f"{side}_ear", f"{other}_ear"))
    seen = np.full((24, 3), 7.0)
    seen[nose], seen[own], seen[far] = (50.0, 60.0, 0.8), (90.0, 91.0, 0.0), (40.0, 70.0, 0.6)
    found = _with_a_whole_head(seen.copy())
    assert found[own].tolist() == found[far].tolist() == [40.0, 70.0, 0.6]
    assert found[nose].tolist() == [50.0, 60.0, 0.8]
    seen[own], seen[nose, 2] = (60.0, 80.0, 0.2), 0.0
    found = _with_a_whole_head(seen.copy())
    assert found[nose].tolist() == pytest.approx([50.0, 75.0, 0.4])
    assert found[own].tolist() == [60.0, 80.0, 0.2]


def test_keypoints_lie_by_the_cameras_name(tmp_path: Path) -> None:
    (tmp_path / "door").mkdir()
    (tmp_path / "door" / "hall_000.json").write_text("{}")
    view = msgspec.structs.replace(view_of("hall.avi"), name="door")
    assert _folder_of(tmp_path, view, alone=False) == tmp_path / "door"
