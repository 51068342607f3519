"""What makes a rig unlikely, held against persons set up by hand."""

import math

import numpy as np
import pytest

from calibration.person.rig_evidence import ClipEvidence, Evidence, Known
from calibration.person.rig_residuals import (
    ALL_WAYS,
    BEHIND,
    UPRIGHT_DEG,
    Explained,
    _length_misfits,
    _one_way,
    _turned,
    data_misfits,
    explained,
    facing_misfits,
    facing_off_deg,
    misfits,
    prior_misfits,
    softened,
    standing_misfits,
)
from calibration.person.rig_starts import known_of
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import JointTrack
from calibration.tracks.rig_guess import BODY, LATE, PLACE, Pinhole, pinholes
from calibration.tracks.sight_lines import Meeting, Numbers
from common.body.body import OTHER_SIDE


def standing(headings_deg: Numbers, lean_deg: float) -> Explained:
    """Who stands there leaning towards the world's x, whichever way they face."""
    points = np.zeros((len(headings_deg), 15, 3))
    points[:, prior.ANKLES, 1] = 0.05
    points[:, prior.NECK] = 0.05 * np.array([0.0, 1.0, 0.0])
    lean = math.radians(lean_deg)
    points[:, prior.NECK] += 1.4 * np.array([math.sin(lean), math.cos(lean), 0.0])
    turn = np.radians(headings_deg)
    across = np.stack([np.cos(turn), np.zeros(len(turn)), -np.sin(turn)], axis=1)
    for joint, side in zip(prior.SHOULDERS, (0.2, -0.2), strict=True):
        points[:, joint] += side * across
    seen = np.ones(points.shape[:2], bool)
    nothing = np.zeros(seen.shape)
    met = Meeting(points, np.zeros((3, *points.shape)), nothing[None], nothing, nothing, seen)
    return Explained(met, seen, nothing, seen, None)  # type: ignore[arg-type]


def test_who_faces_one_way_may_lean_by_a_habit() -> None:
    lean = standing_misfits(standing(np.zeros(40), 3.0), 1.75)[1]
    assert lean == pytest.approx([3.0 / UPRIGHT_DEG, 0.0], abs=1e-2)


def test_who_faces_all_ways_and_leans_one_way_shows_a_vertical_that_is_wrong() -> None:
    all_round = np.linspace(0.0, 351.0, 40)
    lean = standing_misfits(standing(all_round, 3.0), 1.75)[1]
    assert lean == pytest.approx([3.0 / (UPRIGHT_DEG * ALL_WAYS), 0.0], abs=1e-2)


def test_who_turns_to_and_fro_between_two_sides_is_between_both() -> None:
    lean = standing_misfits(standing(np.tile([-60.0, 60.0], 20), 3.0), 1.75)[1]
    assert lean[0] == pytest.approx(3.0 / (UPRIGHT_DEG * math.hypot(0.5, ALL_WAYS)), rel=1e-3)


def met_anywhere(n: int = 4) -> Explained:
    """Sight lines that meet, segments as long as they should be, before both cameras."""
    zeros, seen = np.zeros((n, 15)), np.ones((n, 15), bool)
    before = seen.copy()
    met = Meeting(
        np.zeros((n, 15, 3)),
        np.zeros((3, n, 15, 3)),
        np.zeros((3, n, 15)),
        zeros,
        zeros.copy(),
        before,
    )
    lengths = np.zeros((n, len(prior.ENDS)))
    return Explained(met, seen, lengths, np.ones(lengths.shape, bool), None)  # type: ignore[arg-type]


def test_a_far_miss_says_that_it_is_wrong_and_no_more() -> None:
    """Cauchy's loss: 2 ln(1 + r^2 / 2)."""
    soft = softened(np.array([0.01, -1.0, 100.0]))
    assert soft**2 == pytest.approx(2.0 * np.log(1.0 + np.array([0.01, 1.0, 100.0]) ** 2 / 2.0))
    assert np.sign(soft).tolist() == [1.0, -1.0, 1.0]


def test_landmarks_that_err_alike_count_by_their_share_and_what_is_unseen_by_a_sigma() -> None:
    one = met_anywhere()
    one.met.gap[0, 3] = 2.0
    one.met.before[1, 4] = False
    one.used[2, 5] = False
    one.lengths[3, 6] = -3.0
    one.lengths_used[3, 7] = False
    gaps, lengths = (part.reshape(4, -1) for part in data_misfits(one, 0.25))
    expected = np.zeros((4, 15))
    expected[0, 3], expected[1, 4], expected[2, 5] = softened(np.array([2.0, BEHIND, 1.0]))
    assert gaps == pytest.approx(0.5 * expected)
    expected = np.zeros(lengths.shape)
    expected[3, 6], expected[3, 7] = softened(np.array([-3.0, 1.0]))
    assert lengths == pytest.approx(0.5 * expected)


@pytest.mark.parametrize(("frames", "few"), [(3, 1.0), (24, 0.5)])
def test_the_lower_foot_stands_on_the_floor_in_six_frames_of_all(frames: int, few: float) -> None:
    one = standing(np.zeros(frames), 0.0)
    one.met.points_m[:, prior.ANKLES, 1] = [0.05 * 1.75 + 0.04, 0.5]
    above = standing_misfits(one, 1.75)[0]
    assert above == pytest.approx(few * softened(np.full(frames, 2.0)))
    one.used[0, prior.ANKLES[0]] = False
    assert standing_misfits(one, 1.75)[0][0] > above[0], "the other foot then"
    one.used[0, prior.ANKLES[1]] = False
    assert standing_misfits(one, 1.75)[0][0] == 0.0


def a_rig(yaw_deg: float = -90.0) -> tuple[Numbers, Known]:
    """What is believed of a rig, and that rig with camera 2 at a yaw."""
    known = known_of(320, 1.75, 1)
    guess = known.mean.copy()
    guess[PLACE["yaw_2"]] = math.radians(yaw_deg)
    high = float(np.exp(guess[BODY])[prior.UPRIGHT].sum())
    guess[BODY] += math.log(1.75 * prior.CROWN_SHARE / high)
    return guess, known


@pytest.mark.parametrize(
    ("name", "off", "sigmas"),
    [("height_1", 0.6, 1.0), ("log_focal_2", 0.3, 1.0), ("height_2", -1.2, -2.0)],
)
def test_what_is_believed_of_a_rig_is_told_in_sigmas(name: str, off: float, sigmas: float) -> None:
    guess, known = a_rig()
    before = prior_misfits(guess, known)[0]
    guess[PLACE[name]] += off
    after = prior_misfits(guess, known)[0]
    assert sorted((after - before)[np.abs(after - before) > 1e-9]) == pytest.approx([sigmas])


def test_what_is_mostly_so_is_softened_and_lenses_are_mostly_alike() -> None:
    guess, known = a_rig()
    assert prior_misfits(guess, known)[1] == pytest.approx(np.zeros(6))
    guess[PLACE["pitch_2"]] = math.radians(12.0)
    guess[PLACE["log_focal_1"]] += 0.6
    soft = prior_misfits(guess, known)[1]
    assert sorted(soft) == pytest.approx(sorted([*np.zeros(4), *softened(np.array([2.0, 2.0]))]))
    assert soft[-1] == pytest.approx(softened(np.array([2.0]))[0])


def test_the_person_is_as_tall_as_is_said_and_camera_2_on_the_left() -> None:
    """A hundredth of a logarithm is a sigma; to the right costs 2.45 of them."""
    stature, right = prior_misfits(*a_rig(-90.0))[2]
    assert stature == pytest.approx(0.0, abs=1e-9)
    assert right == pytest.approx(0.0, abs=1e-3)
    guess, known = a_rig(90.0)
    assert prior_misfits(guess, known)[2][1] == pytest.approx(2.45, abs=1e-3)
    guess, known = a_rig(0.0)
    guess[BODY] += 0.02
    stature, right = prior_misfits(guess, known)[2]
    assert stature == pytest.approx(2.0)
    assert right == pytest.approx(2.45 / 2)


@pytest.mark.parametrize(
    ("off_deg", "sure", "misfit"),
    [
        (0.0, 0.9, 0.0),
        (60.0, 0.9, 2.0 * math.sin(math.radians(30.0)) / math.radians(20.0)),
        (180.0, 0.85, 2.0 / math.radians(20.0)),
        (60.0, 0.725, 0.5 * 2.0 * math.sin(math.radians(30.0)) / math.radians(20.0)),
        (60.0, 0.6, 0.0),
    ],
)
def test_views_that_see_a_person_face_other_ways_disagree_as_surely_as_both_are(
    off_deg: float, sure: float, misfit: float
) -> None:
    """Camera 1 is before the person, camera 2 at the left: at 90 degrees to the right for it."""
    guess, _ = a_rig()
    guess[PLACE["x_2"]], guess[PLACE["z_2"]] = 3.0, -3.0
    one = met_anywhere(16)
    one.met.points_m[:, prior.PELVIS] = (0.0, 1.0, -3.0)
    first = facings(0.0, sure, 16)
    one = one._replace(second=facings(-90.0 + off_deg, min(1.0, sure + 0.1), 16))
    found = facing_misfits(guess, one, first)
    soft = softened(np.array([misfit if sure >= 0.85 else 2 * misfit]))[0]
    weight = math.sqrt(8.0 / 16) * (1.0 if sure >= 0.85 else (0.5 if sure > 0.7 else 0.0))
    assert np.abs(found) == pytest.approx(np.full(16, weight * soft), abs=1e-6)
    told = facing_off_deg(guess, one, first)
    assert told == pytest.approx(off_deg if sure > 0.85 else 0.0, abs=1e-6)


def facings(facing_deg: float, sure: float, n: int) -> JointTrack:
    zeros = np.zeros((n, 15))
    return JointTrack(
        np.arange(n) / 15,
        np.zeros((n, 15, 2)),
        zeros,
        np.full(n, facing_deg),
        np.full(n, sure),
    )


def test_of_few_moments_nothing_is_told_of_facings() -> None:
    guess, _ = a_rig()
    one = met_anywhere(11)._replace(second=facings(120.0, 0.95, 11))
    assert facing_off_deg(guess, one, facings(0.0, 0.95, 11)) == 0.0


def a_person(frames: int) -> Numbers:
    """(frames, 15, 3) joints that all move, each by itself, about 4 m before camera 1."""
    rng = np.random.default_rng(5)
    middle = np.array([0.2, 1.0, -4.0]) + rng.normal(0.0, (0.3, 0.5, 0.2), (15, 3))
    way = rng.normal(0.0, 0.02, (15, 3))
    moved: Numbers = middle + np.arange(frames)[:, None, None] * way
    return moved


def pictured(camera: Pinhole, points_m: Numbers, size_px: tuple[int, int]) -> Numbers:
    """Where a camera shows points (..., 3), its axis in the middle of the picture."""
    seen = (points_m - camera.centre_m) @ camera.R.T
    return np.asarray(camera.focal_px * seen[..., :2] / seen[..., 2:] + np.array(size_px) / 2)


def test_a_right_rig_explains_a_clip_by_the_points_themselves() -> None:
    """The second of two clips: view 2 is two frames late there, has the arms of one moment
    exchanged, and each view is unsure of a joint of its own."""
    size_px, shift, n = (320, 200), 2, 4
    points_m, (guess, known) = a_person(n), a_rig(-80.0)
    guess = np.append(guess, shift / 4)
    guess[LATE] = 0.7
    guess[PLACE["x_2"]], guess[PLACE["z_2"]] = -3.5, -4.4
    guess[PLACE["height_2"]], guess[PLACE["pitch_1"]] = 1.5, 0.05
    one, other = pinholes(guess)
    first_px, second_px = (pictured(camera, points_m, size_px) for camera in (one, other))
    second_px = np.concatenate([np.zeros((shift, 15, 2)), second_px])
    arms = np.array([prior.PART_OF_JOINT[joint] == prior.ARMS for joint in range(15)])
    second_px[shift + 1, arms] = second_px[shift + 1, OTHER_SIDE][arms]
    sure_1, sure_2 = np.full((n, 15), 0.9), np.full((n + shift, 15), 0.6)
    sure_1[0, prior.NECK] = 0.1
    sure_2[shift + 2, prior.ANKLES[0]] = 0.1
    nothing = np.zeros(n + shift)
    first = JointTrack(np.arange(n) / 4, first_px, sure_1, nothing[:n], nothing[:n])
    second = JointTrack(np.arange(n + shift) / 4, second_px, sure_2, nothing, nothing)
    clip = ClipEvidence(first, second, (90.0, 60.0))
    empty = clip._replace(first=second, second=first)
    sides = np.zeros((n, 3), bool)
    sides[1, prior.ARMS] = True
    found = explained(guess, Evidence((empty, clip), size_px, known, 5.0), 1, sides)

    assert found.met.points_m == pytest.approx(points_m, abs=1e-6)
    assert found.second.joints_px == pytest.approx(pictured(other, points_m, size_px))
    used = np.ones((n, 15), bool)
    used[0, prior.NECK] = used[2, prior.ANKLES[0]] = False
    assert (found.used == used).all()
    near, far = prior.ENDS.T
    assert (found.lengths_used == (used[:, near] & used[:, far])).all()
    assert found.met.before.all()
    sigma_1_px = 0.03 * 90.0 / math.sqrt(-2.0 * math.log(0.1))
    depth_m = (points_m - one.centre_m) @ one.R[2]
    both = found.met.variances_m2[1] * np.maximum(
        1.0 - ((found.met.axes[0] * found.met.axes[1]).sum(axis=-1)) ** 2, 0.2
    )
    assert both[3, 4] == pytest.approx((sigma_1_px / one.focal_px * depth_m[3, 4]) ** 2)
    sigma_2_px = 0.03 * 60.0 / math.sqrt(-2.0 * math.log(0.4))
    depth_m = (points_m - other.centre_m) @ other.R[2]
    both = found.met.variances_m2[0] * np.maximum(
        1.0 - ((found.met.axes[0] * found.met.axes[1]).sum(axis=-1)) ** 2, 0.2
    )
    assert both[3, 4] == pytest.approx((sigma_2_px / other.focal_px * depth_m[3, 4]) ** 2)


def test_a_segment_with_an_end_behind_a_camera_is_not_used() -> None:
    guess, known = a_rig(-90.0)
    guess[PLACE["x_2"]], guess[PLACE["z_2"]] = -4.0, -4.0
    points_m = a_person(3)
    points_m[1, prior.PELVIS] = (0.4, 1.0, 2.0)
    views_px = [pictured(camera, points_m, (320, 240)) for camera in pinholes(guess)]
    sure, nothing = np.full((3, 15), 0.9), np.zeros(3)
    tracks = [JointTrack(np.arange(3) / 10, px, sure, nothing, nothing) for px in views_px]
    evidence = Evidence((ClipEvidence(tracks[0], tracks[1], (90.0, 90.0)),), (320, 240), known, 5.0)
    found = explained(guess, evidence, 0, np.zeros((3, 3), bool))
    unused = np.zeros((3, len(prior.ENDS)), bool)
    unused[1, (prior.ENDS == prior.PELVIS).any(axis=1)] = True
    assert found.used.all()
    assert not found.met.before[1, prior.PELVIS]
    assert (found.lengths_used != unused).all()


def test_a_segments_misfit_is_its_error_over_that_of_both_ends_and_of_the_body() -> None:
    """Worked by hand: the trunk 0.1 m too long along y, where one end is known to 0.03 m and the
    other to 0.04 m."""
    points = np.zeros((2, 15, 3))
    points[:, prior.NECK] = (0.0, 0.6, 0.0)
    variances = np.zeros((3, 2, 15))
    variances[1, :, prior.PELVIS], variances[1, :, prior.NECK] = 0.03**2, 0.04**2
    variances[0], variances[2] = 7.0, 8.0
    axes = np.broadcast_to(np.eye(3)[:, None, None, :], (3, 2, 15, 3))
    met = met_anywhere(2).met._replace(points_m=points, axes=axes, variances_m2=variances)
    lengths_m = np.array([0.5, 0.3, 0.25, 0.24, 0.42, 0.4, 0.35, 0.2])
    own_m = 0.012 / 0.952 * (0.5 + 0.3 + 0.42 + 0.4)
    found = _length_misfits(met, lengths_m)
    assert found.shape == (2, 12)
    assert found[:, 0] == pytest.approx([0.1 / math.sqrt(0.05**2 + own_m**2)] * 2)


def test_all_misfits_of_all_clips_follow_one_another() -> None:
    """What is believed first, then of each clip landmarks, standing and facings, of its own sides
    and of landmarks' share."""
    guess, known = a_rig(-90.0)
    guess = np.append(guess, 0.0)
    known = known_of(320, 1.75, 2)
    guess[PLACE["x_2"]], guess[PLACE["z_2"]] = -4.0, -4.0
    clips = []
    for n, facing in ((3, 20.0), (5, 70.0)):
        views_px = [pictured(camera, a_person(n), (320, 240)) for camera in pinholes(guess)]
        sure = np.full(n, 0.9)
        tracks = [
            JointTrack(np.arange(n) / 10, px, np.full((n, 15), 0.8), np.full(n, way), sure)
            for px, way in zip(views_px, (0.0, facing), strict=True)
        ]
        clips.append(ClipEvidence(tracks[0], tracks[1], (90.0, 80.0)))
    evidence = Evidence(tuple(clips), (320, 240), known, 2.0)
    sides = (np.zeros((3, 3), bool), np.tile([False, True, False], (5, 1)))
    rows = [*prior_misfits(guess, known)]
    for n in (0, 1):
        one = explained(guess, evidence, n, sides[n])
        rows += [*data_misfits(one, 2.0 / 8.0), *standing_misfits(one, 1.75)]
        rows.append(facing_misfits(guess, one, clips[n].first))
    assert misfits(guess, evidence, sides) == pytest.approx(np.concatenate(rows))


def test_who_stands_upright_has_the_neck_nearly_as_far_from_the_ankles_as_ever() -> None:
    """A frame of ten in which it is nearer than 0.93 of the most leans, and says nothing; one
    whose ankle is unseen neither."""
    one = standing(np.linspace(0.0, 324.0, 10), 0.0)
    one.met.points_m[:3, prior.NECK] = (0.5, 1.0, 0.4)
    one.met.points_m[3:5, prior.NECK] = (0.6, 1.35, -0.7)
    one.used[3:5, prior.ANKLES[1]] = False
    one.met.points_m[5:, prior.NECK] = (0.1, 1.35, -0.2)
    lean = standing_misfits(one, 1.75)[1]
    tall = math.sqrt(0.1**2 + 1.3**2 + 0.2**2)
    lean_deg = UPRIGHT_DEG * min(1.0, math.hypot(_one_way(one.met.points_m, one.used), ALL_WAYS))
    assert lean == pytest.approx(np.degrees([0.1 / tall, -0.2 / tall]) / lean_deg)
    one.met.points_m[:3, prior.NECK] = (0.3, 1.2, 0.4)
    few = standing_misfits(one, 1.75)[1]
    assert few == pytest.approx(lean), "0.95 of the most is upright, and the median as before"
    one.used[:] = False
    assert standing_misfits(one, 1.75)[1].tolist() == [0.0, 0.0]
    assert _one_way(one.met.points_m, one.used) == 1.0


def test_a_facing_is_that_of_the_ray_to_the_camera_and_what_the_view_sees() -> None:
    """Worked by hand: camera 1 stands 45 degrees to the person's +z, camera 2 at -90 from there;
    30 and 80 degrees to the right of them are 75 and -10 in the world."""
    guess, _ = a_rig(-90.0)
    guess[PLACE["x_2"]], guess[PLACE["z_2"]] = -5.0, -2.0
    one = met_anywhere(1)
    one.met.points_m[:, prior.PELVIS] = (-2.0, 1.0, -2.0)
    one = one._replace(second=facings(80.0, 0.7, 1))
    turned, sure = _turned(guess, one, facings(30.0, 0.9, 1))
    assert np.degrees(turned) == pytest.approx([75.0 - (-10.0)])
    assert sure == pytest.approx([0.7])


def test_lenses_are_alike_as_far_as_both_are_what_is_believed_of_each() -> None:
    guess, known = a_rig()
    mean = known.mean.copy()
    mean[1] += 0.15
    assert prior_misfits(guess, known._replace(mean=mean))[1][-1] == pytest.approx(
        softened(np.array([0.5]))[0]
    )
