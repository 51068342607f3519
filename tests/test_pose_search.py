"""One view's search put together: where it starts, what it votes, which angles it tells."""

from typing import Any

import msgspec
import numpy as np
import pytest
from posing import BODY, SIZE, box_around, picture, posed, view

from common.body.body import POSE_INDEX, rest_pose
from common.body.kinematics import ALL_LIMBS
from common.body.observation import Facing, Observation, Search
from common.body.proportions import body_vector, stature, thesis_bdp
from common.bus.messages import Guide, ViewerNumber
from common.config.part_settings import SearchSettings
from common.method import DEFAULT, PAPER, Method
from common.raster.kernel import CENTRE_X, CENTRE_Y, FOCAL_X
from common.raster.silhouette_report import pack
from common.raster.similarity import Mask
from common.rig.camera import PAPER_ROTATIONS
from viewer.expected_body import expected_body
from viewer.paper import pose_search
from viewer.paper.facing import thresholds_px, upper_body_px
from viewer.paper.pose_search import (
    FACADE_ANGLES,
    FLANK_ANGLES,
    SQUAT_ANGLES,
    Found,
    State,
    _at_rest,
    _expected,
    _found,
    _limbs,
    _voted,
    init,
    step,
)
from viewer.paper.posed_model import PosedModel, model_over
from viewer.paper.position import UPRIGHT

BDP = thesis_bdp(1.0)
ROOTS_PX = ((80.0, 64.0), (70.0, 62.0))


def state_of(viewer: ViewerNumber = 1, method: Method = PAPER) -> State:
    return init(viewer, None, SearchSettings(), method)


def seen_as(mask: Mask) -> Observation:
    return Observation(
        width=SIZE[0],
        height=SIZE[1],
        silhouette=pack(mask),
        box=box_around(mask),
        area_px=int(mask.sum()),
    )


def searched(person: Observation) -> Search:
    assert person.search is not None
    return person.search


def guide_of(**changed: Any) -> Guide:
    guide = Guide(
        frame=2,
        captured_s=0.1,
        clock_s=0.1,
        frames=(2, 2),
        status="tracking",
        bdp=BDP,
        measured=True,
        scale_px_per_m=(100.0, 90.0),
        root_px=ROOTS_PX,
        rest_row_px=(64.0, 62.0),
        pose=tuple(posed().tolist()),
    )
    return msgspec.structs.replace(guide, **changed)


@pytest.mark.parametrize(("viewer", "facing"), [(1, "facade"), (2, "flank")])
def test_a_view_starts_as_the_print_says(viewer: ViewerNumber, facing: Facing) -> None:
    """P47; the rotation is the paper's where no calibration is given."""
    state = state_of(viewer)
    assert (state.vote, state.viewer, state.found) == (facing, viewer, None)
    assert state.rotation.tolist() == np.array(PAPER_ROTATIONS[viewer - 1]).tolist()


def stands_in(rows: tuple[int, int], columns: tuple[int, int]) -> Mask:
    """A trunk, with an arm to the right of the picture that is half of its mass."""
    mask = np.zeros(SIZE[::-1], np.bool_)
    mask[rows[0] : rows[1], columns[0] : columns[1]] = True
    mask[rows[0] + 10 : rows[0] + 20, columns[1] : columns[1] + 40] = True
    return mask


@pytest.mark.parametrize("known", [False, True])
def test_a_body_of_which_nothing_is_known_stands_in_its_box(known: bool) -> None:
    """Rows 20 to 99 are 80 px; legs are 98 of the thesis's 175; the middle is that of the mass."""
    mask = stands_in((20, 100), (50, 60))
    bdp = thesis_bdp(2.0) if known else thesis_bdp(1.0)
    guide = guide_of(bdp=bdp, status="lost", facing=("flank", "facade")) if known else None
    model = _at_rest(state_of(), mask, seen_as(mask), guide)
    middle = (800 * 55.0 + 400 * 80.0) / 1200
    assert model.view[CENTRE_X] == pytest.approx(middle)
    assert model.view[CENTRE_Y] == pytest.approx(100.0 - 80.0 * 98 / 175)
    assert model.view[FOCAL_X] == pytest.approx(80.0 / stature(bdp))
    assert model.seen_px == 1200
    assert model.width == SIZE[0]
    assert model.body == pytest.approx(body_vector(bdp))
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = -90.0 if known else 0.0
    assert model.pose.tolist() == pose.tolist()


@pytest.mark.parametrize(("viewer", "facing", "yaw_deg"), [(2, "facade", -90.0), (2, "flank", 0.0)])
def test_a_resting_body_is_turned_as_its_view_takes_itself_to_see_it(
    viewer: ViewerNumber, facing: Facing, yaw_deg: float
) -> None:
    mask = stands_in((20, 100), (50, 60))
    state = state_of(viewer)._replace(vote=facing)
    model = _at_rest(state, mask, seen_as(mask), None)
    assert model.pose[POSE_INDEX["torso_y"]] == yaw_deg


@pytest.mark.parametrize(
    ("method", "facing", "knee_deg"),
    [(PAPER, "facade", -44.0), (PAPER, "flank", -10.0), (DEFAULT, "facade", -10.0)],
    ids=["its own", "of another facing", "both views'"],
)
def test_as_printed_a_view_goes_on_from_the_angles_that_it_found(
    method: Method, facing: Facing, knee_deg: float
) -> None:
    """L1; the place in the picture is the guide's, and the pose has none of its own."""
    mask = picture(posed())
    guide = guide_of(pose=tuple(posed(r_knee_x=-10.0, neck_z=7.0).tolist()))
    known = expected_body(guide, 2)
    assert known is not None
    known = known._replace(pose=(1.0, 2.0, 3.0, 4.0, *known.pose[4:]))
    state = state_of(2, method)._replace(found=Found("facade", {"r_knee_x": -44.0}, True))
    model = _expected(state, mask, known, facing)
    assert model.pose[POSE_INDEX["r_knee_x"]] == knee_deg
    assert model.pose[POSE_INDEX["neck_z"]] == 7.0
    assert model.pose[:4].tolist() == [0.0, 0.0, 0.0, 4.0]
    assert model.view[[CENTRE_X, CENTRE_Y, FOCAL_X]].tolist() == [70.0, 62.0, 90.0]
    assert model.view[:9].tolist() == np.array(PAPER_ROTATIONS[1]).ravel().tolist()


@pytest.mark.parametrize(
    ("facing", "squatting", "kept"),
    [("facade", False, False), ("facade", True, True), ("flank", False, True)],
)
def test_the_facade_goes_on_with_legs_only_in_a_squat(
    facing: Facing, squatting: bool, kept: bool
) -> None:
    """P33."""
    angles = {"r_shoulder_z": 20.0, "r_hip_x": 5.0, "l_knee_x": -9.0}
    found = _found(facing, angles, squatting)
    assert (found.facing, found.squatting) == (facing, squatting)
    assert found.angles_deg == (angles if kept else {"r_shoulder_z": 20.0})


def test_a_view_votes_by_the_width_that_it_sees_at_the_size_of_the_body() -> None:
    """P24 to P26: the width of columns above the hips against the trunk's at 55 and 35 degrees."""
    mask = picture(posed(r_shoulder_z=90.0, l_shoulder_z=270.0))
    known = expected_body(guide_of(), 1)
    assert known is not None
    model = model_over(mask, BODY, posed(), view(1))
    state, width_px, limits = _voted(state_of(), mask, model, known)
    assert width_px == upper_body_px(mask, 64.0, 100.0 * BDP.torso.height) > 15.0
    assert limits == thresholds_px(BDP, 100.0)
    assert state.vote == "facade"
    thin = picture(posed(r_shoulder_x=90.0, l_shoulder_x=90.0), viewer=2)
    assert _voted(state_of(), thin, model, known)[0].vote == "flank"


def test_before_a_guide_a_view_keeps_its_vote() -> None:
    model = model_over(picture(posed()), BODY, posed(), view(1))
    state = state_of()
    assert _voted(state, picture(posed()), model, None) == (state, 0.0, (0.0, 0.0))


def model_at(row_px: float, viewer: ViewerNumber = 1) -> PosedModel:
    return model_over(picture(posed(), viewer), BODY, posed(), view(viewer, (80.0, row_px)))


@pytest.mark.parametrize(
    ("row_px", "before", "measured", "squatting"),
    [
        (68.5, False, True, True),
        (67.5, False, True, False),
        (67.5, True, True, True),
        (66.0, True, True, False),
        (75.0, False, False, False),
        (55.0, False, True, False),
    ],
)
def test_the_facade_squats_by_the_drop_of_its_navel(
    row_px: float, before: bool, measured: bool, squatting: bool
) -> None:
    """P33: 4 % of the stature (100 px) below its row of standing, and up again at 2.5 %."""
    known = expected_body(guide_of(measured=measured), 1)
    state = state_of()._replace(found=Found("facade", {}, before))
    model, found = _limbs(state, model_at(row_px), known, "facade")
    assert found == squatting
    bent = [name for name in SQUAT_ANGLES if model.pose[POSE_INDEX[name]] != 0.0]
    assert squatting or not bent


def test_the_drop_is_counted_in_statures_and_metres() -> None:
    """Four pixels of a body drawn half as large, or twice as tall in the guide's unit."""
    known = expected_body(guide_of(bdp=thesis_bdp(2.0), scale_px_per_m=(30.0, 30.0)), 1)
    assert known is not None
    for row_px, squatting in ((66.0, False), (66.8, True)):
        assert _limbs(state_of(), model_at(row_px), known, "facade")[1] is squatting


@pytest.mark.parametrize("viewer", [1, 2])
def test_the_flank_searches_the_near_side_first(
    monkeypatch: pytest.MonkeyPatch, viewer: ViewerNumber
) -> None:
    """C1: camera 2 looks along +x and has the right of who faces camera 1 nearer; a person who
    turned their flank to camera 1 has their left there."""
    near = []

    def searched(model: PosedModel, _settings: object, side: int, *_: object, **__: object) -> Any:
        near.append(side)
        return model

    monkeypatch.setattr(pose_search, "flank_arms", searched)
    monkeypatch.setattr(pose_search, "flank_legs", searched)
    _, squatting = _limbs(state_of(viewer), model_at(75.0), expected_body(guide_of(), 1), "flank")
    assert near == [viewer % 2] * 2
    assert not squatting


def test_a_step_finds_the_arms_of_the_facade_where_the_body_stands() -> None:
    """Nothing known, then a guide: names of the facade, the place, and what was matched."""
    mask = picture(posed(r_shoulder_z=60.0, l_shoulder_z=290.0), root_px=(83.0, 62.0))
    state, first = step(state_of(), seen_as(mask), mask, None)
    assert set(searched(first).angles_deg) == set(FACADE_ANGLES)
    assert searched(first).angles_deg["r_shoulder_z"] == pytest.approx(60.0, abs=6.0)
    assert searched(first).angles_deg["l_shoulder_z"] == pytest.approx(290.0, abs=6.0)
    assert (first.upper_body_px, first.vote, first.thresholds_px) == (0.0, "facade", (0.0, 0.0))
    assert searched(first).matches > 20
    assert searched(first).score > 0.6
    assert not searched(first).squatting
    guide = guide_of(root_px=((81.0, 63.0), (0.0, 0.0)))
    state, second = step(state, seen_as(mask), mask, guide)
    assert searched(second).root_px == (83.0, 62.0)
    assert second.upper_body_px > 0.0
    assert second.thresholds_px == thresholds_px(BDP, 100.0)
    assert state.found is not None
    assert state.found.angles_deg == {
        name: value
        for name, value in searched(second).angles_deg.items()
        if name not in SQUAT_ANGLES
    }


@pytest.mark.parametrize(
    ("viewer", "facing", "names"),
    [
        (1, ("flank", "facade"), FLANK_ANGLES),
        (2, ("flank", "facade"), FACADE_ANGLES),
        (2, ("facade", "flank"), FLANK_ANGLES),
    ],
)
def test_a_step_searches_as_the_guide_says_that_its_view_faces(
    viewer: ViewerNumber, facing: tuple[Facing, Facing], names: tuple[str, ...]
) -> None:
    mask = picture(posed(), viewer)
    guide = guide_of(facing=facing)
    _, report = step(state_of(viewer), seen_as(mask), mask, guide)
    assert set(searched(report).angles_deg) == set(names)


@pytest.mark.parametrize(("method", "limbs"), [(PAPER, ALL_LIMBS), (DEFAULT, UPRIGHT)])
def test_what_is_shifted_is_the_methods(
    monkeypatch: pytest.MonkeyPatch, method: Method, limbs: int
) -> None:
    """P27: as printed the whole model, else what stands."""
    asked = []

    def located(model: PosedModel, which: int) -> PosedModel:
        asked.append(which)
        return model

    monkeypatch.setattr(pose_search, "located", located)
    mask = picture(posed())
    step(state_of(1, method), seen_as(mask), mask, guide_of())
    assert asked == [limbs]
