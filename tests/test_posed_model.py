"""The model as one viewer sees it: where it lies, what turns, how far a search reaches."""

import numpy as np
import pytest
from posing import BODY, SIZE, angle, laid_over, picture, posed, view

from common.body.body import POSE_INDEX
from common.body.kinematics import ARM_LIMBS, LEG_LIMBS
from common.body.observation import Facing
from common.bus.messages import ViewerNumber
from common.raster.kernel import draw_body
from common.rig.camera import paper_rig
from viewer.paper import posed_model
from viewer.paper.posed_model import SearchRange, rotation_of, searched, turn, view_at, yaw_of

SHOULDER = turn(ARM_LIMBS[0], r_shoulder_z=1.0)


@pytest.mark.parametrize("viewer", [1, 2])
def test_the_navel_is_drawn_where_the_view_has_it(viewer: ViewerNumber) -> None:
    """Rows run down: at (80, 64) with 100 px a stature of 1 the feet end at row 120."""
    mask = picture(posed(), viewer)
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    assert abs(rows[-1] + 1 - (64 + 56)) <= 1
    assert columns[0] + columns[-1] + 1 == 160


@pytest.mark.parametrize(("viewer", "column"), [(1, 40), (2, 120)])
def test_pictures_run_as_the_conventions_say(viewer: ViewerNumber, column: int) -> None:
    """C1, C2: the right arm is on the left of picture 1; what is forward on the right of 2."""
    pose = posed(**({"r_shoulder_z": 90.0} if viewer == 1 else {"r_shoulder_x": 90.0}))
    with_arm, without = picture(pose, viewer), picture(posed(), viewer)
    columns = np.flatnonzero((with_arm & ~without).any(axis=0))
    assert abs(columns - 80.0).max() > 35
    assert ((columns < 80) == (column < 80)).all()


def test_a_calibrated_camera_of_the_papers_kind_turns_the_world_as_the_papers() -> None:
    """C1."""
    viewers: tuple[ViewerNumber, ...] = (1, 2)
    for viewer, camera in zip(viewers, paper_rig(SIZE, (9, 9), (4, 4)).cameras, strict=True):
        assert (rotation_of(camera, viewer) == rotation_of(None, viewer)).all()
    assert (rotation_of(None, 3) == rotation_of(None, 2)).all()


def test_size_follows_the_scale() -> None:
    half = draw_body(BODY, posed(), view_at(rotation_of(None, 1), 50.0, (80.0, 64.0)), SIZE)
    assert half.sum() == pytest.approx(picture(posed()).sum() / 4, rel=0.05)


@pytest.mark.parametrize(
    ("facing", "viewer", "yaw_deg"),
    [("facade", 1, 0.0), ("flank", 2, 0.0), ("flank", 1, -90.0), ("facade", 2, -90.0)],
)
def test_a_facing_stands_for_one_yaw_of_the_trunk(
    facing: Facing, viewer: ViewerNumber, yaw_deg: float
) -> None:
    """P49, C2: at -90 degrees the person faces camera 2, on -x."""
    assert yaw_of(facing, viewer) == yaw_deg


def test_a_turn_moves_its_angle_and_what_is_coupled_to_it() -> None:
    """P34."""
    how = turn(LEG_LIMBS[1], l_hip_x=1.0, l_knee_x=-2.0)
    moved = {name: how.step[i] for name, i in POSE_INDEX.items() if how.step[i]}
    assert moved == {"l_hip_x": 1.0, "l_knee_x": -2.0}
    assert how.at == POSE_INDEX["l_hip_x"]
    assert how.moving == 1 << 3 | 1 << 5


def test_a_search_reaches_half_a_window_and_a_wide_one_everywhere() -> None:
    """P38, P41: +-32 degrees a frame for an arm; limitation L1 beyond."""
    seen = picture(posed(r_shoulder_z=20.0))
    start = laid_over(seen, posed(r_shoulder_z=170.0))
    near = searched(start, SHOULDER, SearchRange(64, 4, (0.0, 180.0)))
    assert 116.0 <= angle(near, "r_shoulder_z") <= 180.0
    assert near.matches <= 9
    wide = searched(start, SHOULDER, SearchRange(64, 4, (0.0, 180.0), wide=True))
    assert angle(wide, "r_shoulder_z") == pytest.approx(20.0, abs=2.0)
    assert wide.score > near.score


def test_a_search_counts_its_matches_and_leaves_the_rest_of_the_pose() -> None:
    start = laid_over(picture(posed()), posed(l_hip_z=190.0))._replace(matches=5)
    found = searched(start, SHOULDER, SearchRange(64, 4, (0.0, 180.0)))
    assert 5 + 6 <= found.matches <= 5 + 9
    changed = np.flatnonzero(found.pose != start.pose)
    assert set(changed) <= {POSE_INDEX["r_shoulder_z"]}
    assert start.matches == 5
    assert view(1)[16] == 1.0


def test_a_wide_search_tiles_the_whole_range(monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows about 32, 96 and 160 degrees, the last pushed inside; the best of all is taken."""
    asked = []

    def search(*given: object) -> tuple[float, float, int]:
        low, high, stop = given[-3:]
        asked.append((low, high, stop))
        return float(low) + 5.0, {0: 0.3, 64: 0.7, 116: 0.5}[int(low)], 6  # type: ignore[call-overload, arg-type]

    monkeypatch.setattr(posed_model, "search", search)
    start = laid_over(picture(posed()), posed())._replace(matches=2)
    found = searched(start, SHOULDER, SearchRange(64, 4, (0.0, 180.0), wide=True))
    assert asked == [(0, 64, 4), (64, 128, 4), (116, 180, 4)]
    assert (angle(found, "r_shoulder_z"), found.score, found.matches) == (69.0, 0.7, 20)


@pytest.mark.parametrize(("gain", "taken"), [(0.09, True), (0.11, False)])
def test_an_angle_changes_for_its_gain_alone(
    monkeypatch: pytest.MonkeyPatch, gain: float, taken: bool
) -> None:
    monkeypatch.setattr(posed_model, "search", lambda *_: (50.0, 0.5, 7))
    start = laid_over(picture(posed()), posed(r_shoulder_z=170.0))._replace(score=0.4, matches=3)
    found = searched(start, SHOULDER, SearchRange(64, 4, (0.0, 180.0)), gain)
    assert angle(found, "r_shoulder_z") == (50.0 if taken else 170.0)
    assert found.score == (0.5 if taken else 0.4)
    assert found.matches == 10


def test_what_is_coupled_to_an_angle_takes_its_share_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posed_model, "search", lambda *_: (30.0, 0.5, 7))
    how = turn(LEG_LIMBS[1], l_hip_x=1.0, l_knee_x=-2.0)
    found = searched(laid_over(picture(posed()), posed()), how, SearchRange(32, 4, (0.0, 75.0)))
    assert (angle(found, "l_hip_x"), angle(found, "l_knee_x")) == (30.0, -60.0)
