"""What a run knows of its clip, by hand: times, sizes, what was read, whose camera is whose."""

import msgspec
import pytest

from common.rig.camera import paper_rig
from common.rig.upright import Upright
from common.video.clip_facts import (
    Clip,
    ClipView,
    Meta,
    camera_names,
    clip_summary,
    set_back,
    shortfall,
    unread,
    unread_facts,
    uprights_of,
    whole_rig,
)
from common.video.pictures import Ending

LYING = Upright(width=160, height=90, quarters=1, square_width=200, square_height=108)
"""Pixels of 160x90 are made square, 200x108, and then turned to stand."""
FIRST = ClipView(1, "a.avi", (1920, 1080), (160, 120), 10.0, 50)
SECOND = msgspec.structs.replace(FIRST, number=2, source="b.avi", late_s=0.25)
RIG = paper_rig((160, 120), (200.0, 210.0), (4.0, 4.5))


def clip_of(*views: ClipView, rig_of: tuple[int, ...] = ()) -> Clip:
    cameras = tuple(RIG.cameras[n - 1] for n in rig_of)
    rig = msgspec.structs.replace(RIG, cameras=cameras) if cameras else None
    return Clip("walk", views, 1, rig, Meta())


def test_a_view_has_the_sizes_of_its_file_of_its_picture_and_of_the_whole_upright() -> None:
    lying = msgspec.structs.replace(FIRST, size=(108, 200), upright=LYING)
    assert (FIRST.quarters, FIRST.filed_size, FIRST.upright_source) == (0, (160, 120), (1920, 1080))
    assert (lying.quarters, lying.filed_size) == (1, (160, 90))
    assert lying.upright_source == (1296, 2400)  # 1080 * 108 / 90 by 1920 * 200 / 160
    twice = msgspec.structs.replace(LYING, quarters=2)
    assert msgspec.structs.replace(FIRST, upright=twice).upright_source == (2400, 1296)


def test_frames_have_their_own_times_then_the_rate_and_a_late_view_is_set_back() -> None:
    timed = msgspec.structs.replace(SECOND, capture_s=(0.5, 0.7, 1.1))
    assert [FIRST.captured_s(n) for n in (0, 7)] == [0.0, 0.7]
    assert [SECOND.captured_s(n) for n in (0, 7)] == pytest.approx([-0.25, 0.45])
    assert [timed.captured_s(n) for n in range(5)] == pytest.approx([0.25, 0.45, 0.85, 0.95, 1.05])


def test_a_span_holds_the_frames_that_begin_before_it_is_over() -> None:
    """Of a view that is late it begins at its own first frame; a millionth is not another frame."""
    assert [SECOND.frames_in(s) for s in (0.0, 0.09, 0.1, 0.11, 0.3, 0.31)] == [1, 1, 1, 2, 3, 4]
    assert FIRST.frames_in(0.3 + 5e-7) == 3
    assert FIRST.frames_in(0.3 + 2e-6) == 4


def test_of_a_view_that_was_picked_the_picked_frames_are_looked_at() -> None:
    thin = msgspec.structs.replace(FIRST, frames=9, picked=(1, 4, 6))
    assert (thin.every(3), FIRST.every(3)) == (1, 3)
    assert [n for n in range(9) if thin.is_looked_at(n)] == [1, 4, 6]
    assert all(FIRST.is_looked_at(n) for n in range(9))
    assert [thin.next_s(n, 5) for n in (0, 1, 3, 4, 6)] == pytest.approx([0.1, 0.4, 0.4, 0.6, 0.9])
    assert FIRST.next_s(4, 3) == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("read", "damaged", "lost", "said"),
    [
        (50, 0, False, ""),
        (40, 0, False, ""),  # its number was of its sound
        (40, 2, True, "a.avi was cut off or is damaged: 40 of 50 frames could be read; copy or "),
        (50, 3, False, "a.avi is damaged in 3 of its 50 frames, where persons may be missed; copy"),
    ],
)
def test_what_could_not_be_read_is_said(read: int, damaged: int, lost: bool, said: str) -> None:
    ending = Ending(read, damaged)
    assert unread(FIRST, ending) is lost
    told = shortfall(FIRST, ending)
    assert told.startswith(said)
    assert bool(told) == bool(said)
    facts = unread_facts([(FIRST, ending), (SECOND, Ending(50))])
    assert facts == ({"unread": {"a.avi": {"read": 40, "of": 50}}} if lost else {})


def test_setting_back_adds_to_what_the_second_view_is_late_already() -> None:
    later = set_back(clip_of(FIRST, SECOND), (0.125,))
    assert [view.late_s for view in later.views] == [0.0, 0.375]
    assert later.views[0] == FIRST


def test_each_viewer_has_its_own_upright_and_one_that_is_not_there_has_none() -> None:
    lying = msgspec.structs.replace(SECOND, upright=LYING)
    assert uprights_of(clip_of(FIRST, lying)) == (None, LYING)
    assert uprights_of(clip_of(lying)) == (None, LYING)
    assert uprights_of(clip_of(msgspec.structs.replace(FIRST, upright=LYING))) == (LYING, None)


def test_a_viewer_that_is_not_there_gets_the_others_camera() -> None:
    first, second = RIG.cameras
    for views, rig_of, due in (
        ((FIRST, SECOND), (1, 2), (first, second)),
        ((FIRST, SECOND), (2, 1), (second, first)),
        ((SECOND,), (2,), (second, second)),
        ((FIRST,), (1,), (first, first)),
    ):
        rig = whole_rig(clip_of(*views, rig_of=rig_of))
        assert rig is not None
        assert rig.cameras == due
    assert whole_rig(clip_of(FIRST, SECOND)) is None


def test_a_clip_has_a_camera_for_each_number_up_to_its_last() -> None:
    """By hand: cameras 1 and 3 of a rig; the second, which is not looked at, gets the first's."""
    third = ClipView(3, "c.avi", (1920, 1080), (160, 120), 10.0, 50, name="door", upright=LYING)
    clip = clip_of(FIRST, third, rig_of=(1, 2))
    rig = whole_rig(clip)
    assert rig is not None
    assert rig.cameras == (RIG.cameras[0], RIG.cameras[0], RIG.cameras[1])
    assert camera_names(clip) == ("cam1", "cam2", "door")
    assert uprights_of(clip) == (None, None, LYING)
    assert camera_names(clip_of(ClipView(2, 0, (8, 6), (8, 6), 15.0, 0))) == ("cam1", "cam2")


def test_a_summary_tells_the_clip_and_its_cameras() -> None:
    meta = Meta(performer="ann", posture="squat")
    told = clip_summary(msgspec.structs.replace(clip_of(FIRST), meta=meta))
    assert told == {
        "clip": "walk",
        "cameras": ["cam1", "cam2"],
        "performer": "ann",
        "posture_meant": "squat",
    }
