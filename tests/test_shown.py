"""What is shown of an instant, held against geometry and Bayes' rule."""

import math

import cv2
import msgspec
import numpy as np
import pytest
from show_page import BDP, RIG, pose_at, snapshot_at, two_at

from animator.page.page_messages import ShownPosture
from animator.page.shown import (
    outline_of,
    probabilities,
    shown_frame,
    shown_posture,
    shown_room,
    trust_of,
)
from animator.scene import PEOPLE, Snapshot
from common.body.body import ANGLES_IN_POSE
from common.bus.messages import Agreement, Performance, Picture, Posture
from common.raster.silhouette_report import mask_of, people_of, silhouette_view
from common.rig.camera import centre
from common.rig.upright import Upright


def test_postures_are_as_probable_as_bayes_has_it_with_equal_priors() -> None:
    told = probabilities({"squat": math.log(0.02) - 700, "kick": math.log(0.06) - 700})
    assert told == pytest.approx({"squat": 0.25, "kick": 0.75})
    assert probabilities({}) == {}


def test_the_headline_is_what_is_under_way_or_else_what_was_performed_last() -> None:
    """As the list of performances has it: the sliding window means something else meanwhile."""
    window = Posture(
        frame=9, captured_s=0.6, clock_s=0.6, name="squat", log_likelihoods={"squat": -1.0}
    )
    kicks = msgspec.structs.replace(window, doing="kick_left_side", times=3)
    shown = shown_posture(kicks, "walk_toward")
    assert shown == ShownPosture("kick_left_side", "kick_left_side", 3, [])
    assert shown_posture(window, "walk_toward") == ShownPosture("walk_toward", "", 0, [])
    assert shown_posture(window) == ShownPosture("", "", 0, [])


def test_rivals_are_those_of_the_posture_in_the_headline() -> None:
    logs = {"squat": math.log(0.03), "walk_toward": math.log(0.01)}
    squat = Posture(frame=9, captured_s=0.6, clock_s=0.6, name="squat", log_likelihoods=logs)
    rivals = [("squat", 0.75), ("walk_toward", 0.25)]
    under_way = msgspec.structs.replace(squat, doing="squat", times=1)
    assert shown_posture(under_way) == ShownPosture("squat", "squat", 1, rivals)
    assert shown_posture(squat, "squat") == ShownPosture("squat", "", 0, rivals)


def test_an_outline_filled_is_the_silhouette_again_within_its_smoothing() -> None:
    report = snapshot_at(4).reports[1]
    mask = mask_of(report)
    filled = np.zeros(mask.shape, np.uint8)
    for points in outline_of(report.people):
        corners = np.array(points).reshape(-1, 2) - 0.5
        cv2.fillPoly(filled, [np.rint(corners).astype(np.int32)], 1)
    union = np.count_nonzero(mask | (filled > 0))
    assert np.count_nonzero(mask & (filled > 0)) > 0.95 * union


def test_the_outlines_of_people_who_overlap_are_those_of_their_union() -> None:
    """Two squares of 20 pixels that share a corner's 10: no hole where both are. The contour goes
    through the centres of pixels, so a square of n has an area of (n - 1)^2."""
    masks = np.zeros((2, 60, 80), np.bool_)
    masks[0, 10:30, 10:30] = masks[1, 20:40, 20:40] = True
    (points,) = outline_of([*people_of(masks[0]), *people_of(masks[1])])
    area = cv2.contourArea(np.array(points, np.float32).reshape(-1, 2))
    assert area == pytest.approx(2 * 19**2 - 9**2, abs=2)
    assert outline_of([]) == []


@pytest.mark.parametrize(("number", "shown"), [(0, 1), (1, 2)])
def test_the_outlines_are_of_everyone_where_several_are_followed(number: int, shown: int) -> None:
    seen = snapshot_at(4)
    assert seen.body is not None
    masks = np.zeros((2, 60, 80), np.bool_)
    masks[0, 10:30, 10:30] = masks[1, 10:30, 40:60] = True
    report = msgspec.structs.replace(
        silhouette_view(1, masks[0], 4), people=(*people_of(masks[0]), *people_of(masks[1]))
    )
    body = msgspec.structs.replace(seen.body, person=number)
    frame = shown_frame(Snapshot(body, {1: report}), (), RIG, 0)
    assert frame is not None
    (view, _) = frame.views
    assert view is not None
    assert len(view.outline) == shown


def test_a_frame_tells_both_views_the_solids_and_the_joints() -> None:
    frame = shown_frame(snapshot_at(4), (), RIG, 7)
    assert frame is not None
    assert (frame.number, frame.words, len(frame.views)) == (7, "tracking", 2)
    assert len(frame.solids) == 24, "ten limbs, ten balls, hands and feet"
    assert {len(solid) for solid in frame.solids} == {13}
    first = frame.views[0]
    assert first is not None
    assert len(first.joints) == 44
    assert len(frame.confidence) == 22
    seen, knee = mask_of(snapshot_at(4).reports[1]), first.joints[14:16]
    assert seen[int(knee[1]), int(knee[0])], "the left knee lies in the silhouette"
    pelvis = np.array(frame.solids[0][:3])
    assert pelvis == pytest.approx(pose_at(4 / 15)[:3], abs=BDP.torso.height)


def test_a_body_without_extremities_is_shown_without_hands_and_feet() -> None:
    """As runs from before 2026-11-23 have it."""
    whole = snapshot_at(4)
    assert whole.body is not None
    none = {"extremities_m": (), "extremities_px": (), "extremities_confidence": ()}
    bare = msgspec.structs.replace(whole.body, **none)
    frame = shown_frame(msgspec.structs.replace(whole, body=bare), (), RIG, 0)
    assert frame is not None
    assert frame.views[0] is not None
    assert (len(frame.solids), len(frame.views[0].joints), len(frame.confidence)) == (20, 30, 15)


def test_how_far_cameras_are_believed_is_told_beside_the_status() -> None:
    body = snapshot_at(0).body
    assert body is not None
    assert trust_of(body) == ""
    agrees = msgspec.structs.replace(
        body, agreement=Agreement(12.4, 3.0, 1.0, 9.0, 1.0), scale_source="calibrated"
    )
    assert trust_of(agrees) == "cameras agree within 12 mm"
    doubted = Agreement(88.0, 3.0, 1.0, 9.0, 0.4)
    by_person = msgspec.structs.replace(agrees, agreement=doubted, scale_source="person")
    assert trust_of(by_person) == (
        "calibrated by the person; cameras agree within 88 mm, the calibration is doubtful"
    )


def test_before_anybody_was_heard_of_there_is_nothing_to_show() -> None:
    assert shown_frame(Snapshot(), (), RIG, 0) is None
    only_body = Snapshot(body=snapshot_at(0).body)
    frame = shown_frame(only_body, (), RIG, 0)
    assert frame is not None
    assert frame.views == [None, None]


def test_the_room_has_each_camera_where_it_stands() -> None:
    room = shown_room(RIG)
    eyes = np.array([camera[0] for camera in room.cameras])
    assert np.linalg.norm(eyes - np.array(room.middle), axis=1) == pytest.approx([4.5, 4.5])
    assert [len(camera) for camera in room.cameras] == [5, 5]


def test_each_person_has_the_advice_of_each_camera() -> None:
    whole = two_at(4)
    (other,) = whole.others
    advised = msgspec.structs.replace(other.body, advice=("", "step back"))
    frame = shown_frame(
        msgspec.structs.replace(whole, others=(msgspec.structs.replace(other, body=advised),)),
        (),
        RIG,
        0,
    )
    assert frame is not None
    assert [view.advice for view in frame.views if view] == ["", ""]
    assert [view.advice for view in frame.others[0].views if view] == ["", "step back"]


def test_a_picture_that_shows_no_scene_is_named_by_its_fault() -> None:
    whole = snapshot_at(4)
    frozen = {
        n: msgspec.structs.replace(report, fault="frozen") if n == 2 else report
        for n, report in whole.reports.items()
    }
    frame = shown_frame(msgspec.structs.replace(whole, reports=frozen), (), RIG, 0)
    assert frame is not None
    assert [view.fault for view in frame.views if view] == ["", "the picture is frozen"]


def test_each_view_is_told_its_own_numbers_as_exactly_as_they_are_drawn() -> None:
    """By hand: views with different joints, scores, facings, pictures; camera 2's is mirrored."""
    whole = snapshot_at(4)
    assert whole.body is not None
    pose = tuple(0.04 + n for n in range(len(whole.body.pose)))
    body = msgspec.structs.replace(
        whole.body,
        frame=41,
        captured_s=1.234567,
        views="both",
        score=(0.98765, 0.12345),
        facing=("flank", "facade"),
        pose=pose,
        confidence=tuple(n / 300 for n in range(15)),
        extremities_confidence=(0.555,) * 7,
        joints_px=tuple(tuple((v + n + 0.26, v + 10.04) for n in range(15)) for v in (30, 60)),
        extremities_px=tuple(tuple((v + n + 0.5, v + 5.0) for n in range(7)) for v in (1, 8)),
    )
    half = Upright(160, 120, 2, 160, 120)
    second = msgspec.structs.replace(whole.reports[2], upright=half)
    picture = Picture(frame=41, captured_s=1.2, clock_s=1.2, viewer=2, jpeg=b"two")
    shown = msgspec.structs.replace(
        whole, body=body, reports={1: whole.reports[1], 2: second}, pictures={2: picture}
    )
    frame = shown_frame(shown, (), RIG, 3)
    assert frame is not None
    assert (frame.frame, frame.time_s, frame.from_views) == (41, 1.2346, "both")
    assert frame.confidence[:5] == [0.0, 0.0, 0.01, 0.01, 0.01]
    assert frame.confidence[15:] == pytest.approx([0.555] * 7, abs=0.0051)
    assert frame.angles == pytest.approx([round(pose[i], 1) for i in ANGLES_IN_POSE])
    one, two = frame.views
    assert one is not None
    assert two is not None
    assert one.joints[:4] == [30.3, 40.0, 31.3, 40.0]
    assert one.joints[30:34] == [1.5, 6.0, 2.5, 6.0]
    assert two.joints[:4] == [round(160 - 60.26, 1), round(120 - 70.04, 1), 98.7, 50.0]
    assert two.joints[30:32] == [151.5, 107.0]
    assert (one.score, two.score) == (0.988, 0.123)
    assert (one.sees, two.sees) == ("side", "front or back")
    assert (one.jpeg, two.jpeg) == (b"", b"two")
    assert (len(one.limbs), len(two.limbs)) == (10, 10)
    assert one.limbs != two.limbs
    alone = msgspec.structs.replace(shown, body=msgspec.structs.replace(body, pose=()))
    frame = shown_frame(alone, (), RIG, 3)
    assert frame is not None
    assert frame.angles == []
    assert frame.views[0] is not None
    assert frame.views[0].sees == ""


def test_numbers_are_rounded_to_what_can_be_seen() -> None:
    """Confidence to hundredths, angles to tenths, times to tenths of a millisecond."""
    snapshot = snapshot_at(4)
    body = snapshot.body
    assert body is not None
    odd = msgspec.structs.replace(
        body,
        captured_s=1.23456789,
        confidence=tuple(0.12345 + i / 100 for i in range(15)),
        extremities_confidence=(0.98765,) * 7,
        pose=tuple(place + 0.1234 for place in body.pose),
        score=(0.87654, 0.12345),
    )
    frame = shown_frame(msgspec.structs.replace(snapshot, body=odd), (), RIG, 0)
    assert frame is not None
    assert frame.time_s == 1.2346
    assert frame.confidence == pytest.approx(
        [round(value, 2) for value in (*odd.confidence, *odd.extremities_confidence)], abs=1e-9
    )
    assert frame.angles == pytest.approx([round(odd.pose[i], 1) for i in ANGLES_IN_POSE], abs=1e-9)
    assert [view and view.score for view in frame.views] == [0.877, 0.123]


def test_the_likeliest_six_rivals_are_told_the_best_first_to_a_hundredth_of_a_percent() -> None:
    logs = {f"posture {n}": math.log(1.0 + 0.37 * ((5 * n) % 9)) for n in range(9)}
    posture = Posture(
        frame=9, captured_s=0.6, clock_s=0.6, name="squat", doing="squat", log_likelihoods=logs
    )
    told = shown_posture(posture)
    assert told is not None
    total = sum(math.exp(value) for value in logs.values())
    shares = {name: math.exp(value) / total for name, value in logs.items()}
    best = sorted(shares, key=lambda name: -shares[name])[:6]
    assert told.rivals == [(name, round(shares[name], 4)) for name in best]


def test_a_view_shows_limbs_where_there_is_a_body_and_nothing_where_it_was_not_heard() -> None:
    snapshot = snapshot_at(4)
    frame = shown_frame(snapshot, (), RIG, 0)
    assert frame is not None
    assert [view and len(view.limbs) for view in frame.views] == [10, 10]
    second = msgspec.structs.replace(snapshot, reports={2: snapshot.reports[2]})
    alone = shown_frame(second, (), RIG, 0)
    assert alone is not None
    assert alone.views[0] is None
    assert alone.views[1] == frame.views[1]
    body = snapshot.body
    assert body is not None
    bare = msgspec.structs.replace(body, pose=())
    without = shown_frame(msgspec.structs.replace(snapshot, body=bare), (), RIG, 0)
    assert without is not None
    assert [view and (view.limbs, view.sees) for view in without.views] == [([], "")] * 2
    assert (without.solids, without.angles) == ([], [])


def test_each_view_has_its_own_joints_score_side_and_picture() -> None:
    snapshot = snapshot_at(4)
    body = snapshot.body
    assert body is not None
    pictures = {
        n: Picture(frame=0, captured_s=0.0, clock_s=0.0, viewer=n, jpeg=bytes([n])) for n in (1, 2)
    }
    frame = shown_frame(msgspec.structs.replace(snapshot, pictures=pictures), (), RIG, 0)
    assert frame is not None
    for own, view in enumerate(frame.views):
        assert view is not None
        assert view.size == (RIG.width, RIG.height)
        assert view.jpeg == bytes([own + 1])
        assert view.score == round(body.score[own], 3)
        assert view.joints[:30] == pytest.approx(np.array(body.joints_px[own]).ravel(), abs=0.051)
        assert view.sees == {"facade": "front or back", "flank": "side"}[body.facing[own]]


def test_a_camera_is_drawn_as_a_pyramid_of_what_it_sees_one_metre_before_it() -> None:
    """Its corners are those of the picture: the rays through them, from upper left on."""
    for camera, drawn in zip(RIG.cameras, shown_room(RIG).cameras, strict=True):
        eye, *corners = (np.array(each) for each in drawn)
        assert eye == pytest.approx(centre(camera), abs=1e-4)
        in_camera = (np.array(corners) - eye) @ np.array(camera.R).T
        assert in_camera[:, 2] == pytest.approx(1.0, abs=1e-3)
        half = np.array([RIG.width / 2 / camera.K[0][0], RIG.height / 2 / camera.K[1][1]])
        signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        assert in_camera[:, :2] == pytest.approx(signs * half, abs=1e-3)


def test_an_outline_of_two_pixels_is_none() -> None:
    mask = np.zeros((12, 16), np.bool_)
    mask[2, 3:5] = True
    mask[6:11, 4:12] = True
    (only,) = outline_of(people_of(mask))
    corners = np.array(only).reshape(-1, 2)
    assert corners.min(axis=0).tolist() == [4.5, 6.5]
    assert corners.max(axis=0).tolist() == [11.5, 10.5]


def test_each_of_several_people_has_a_body_a_colour_and_a_posture_of_their_own() -> None:
    squat = Performance("squat", 0, 3, 0.0, 0.2, 1.0, 1)
    seen = two_at(4)
    ended = [changed_posture(seen.others[0].posture, event=squat)]
    frame = shown_frame(seen, ended, RIG, 0)
    assert frame is not None
    (other,) = frame.others
    people = [frame, other]
    assert [one.person for one in people] == [1, 2]
    assert [one.posture and one.posture.name for one in people] == ["walk_in_place", "squat"]
    assert [(event.person, event.name) for event in frame.events] == [(2, "squat")]
    for number, one in enumerate(people):
        assert one.solids[0][10:] == pytest.approx(PEOPLE[number], abs=23), "paled by a tenth"
        assert one.solids[0][0] == pytest.approx((-0.7, 0.7)[number], abs=0.02)
        fit, body = one.views[0], (seen.body, seen.others[0].body)[number]
        assert fit is not None
        assert body is not None
        assert fit.joints[:2] == pytest.approx(body.joints_px[0][0], abs=0.06)


def test_a_person_whom_no_camera_shows_now_is_told_without_a_body() -> None:
    seen = two_at(4)
    (other,) = seen.others
    lost = msgspec.structs.replace(other.body, status="lost", pose=(), joints_px=())
    shown = shown_frame(
        msgspec.structs.replace(seen, others=(msgspec.structs.replace(other, body=lost),)),
        (),
        RIG,
        0,
    )
    assert shown is not None
    (told,) = shown.others
    assert (told.person, told.words, told.solids, told.angles) == (2, "lost, searching", [], [])


def changed_posture(posture: Posture | None, event: Performance) -> Posture:
    assert posture is not None
    return msgspec.structs.replace(posture, event=event)
