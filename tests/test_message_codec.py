"""What is said on the bus comes back as it was said, and nothing else is taken for it."""

from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as shapes

from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMBS, POSE_NAMES, rest_pose
from common.body.extremities import EXTREMITY_NAMES
from common.body.observation import Box, Fit, Landmarks, Measure, Observation, Search
from common.body.proportions import thesis_bdp
from common.bus import control_messages, messages
from common.bus.control_messages import (
    Answer,
    Cameras,
    ClockAnswer,
    ClockQuestion,
    Command,
    Ended,
    Pulse,
)
from common.bus.false_messages import MalformedMessage
from common.bus.message_codec import (
    MAX_BYTES,
    TOPICS,
    decode,
    encode,
    key_of,
    pattern_of,
    refuse_size,
)
from common.bus.messages import (
    PROTOCOL,
    Body,
    Guide,
    Lifting,
    Message,
    Moment,
    Picture,
    Posture,
    View,
)
from common.raster.silhouette_report import mask_of, pack
from common.rig.camera import paper_rig
from common.rig.upright import Shift, Upright

BDP = thesis_bdp(1.75)
MEASURE = Measure(
    height_px=66.0, centre_px=(80.0, 55.5), depth_px=7.5, bdp_px=BDP, arms_z_deg=(91.0, 269.0)
)
FIT = Fit(
    joints_px=((1.5, 2.5),) * len(JOINT_NAMES),
    ratios=(1.0,) * 9 + (0.5,),
    breadth=0.9,
    stature_px=66.0,
    hidden=(False,) * 9 + (True,),
    score=0.8,
    matches=3000,
)
LANDMARKS = Landmarks(
    joints_px=((6.5, 1.5),) * len(JOINT_NAMES),
    confidence=(0.0, 1.0) + (0.5,) * (len(JOINT_NAMES) - 2),
    extremities_px=((3.5, -4.0),) * len(EXTREMITY_NAMES),
    extremities_confidence=(0.0, 0.25, 1.0, 0.5, 0.5, 0.5, 0.5),
    facing_deg=-90.0,
    facing_confidence=0.75,
    second_px=((9.5, -2.5),) * len(JOINT_NAMES),
    second_confidence=(0.0, 0.25) + (0.125,) * (len(JOINT_NAMES) - 2),
)
SEARCH = Search((6.5, 1.5), {"r_shoulder_x": 17.0}, False, 0.8, 40)
PERSON = Observation(
    width=13,
    height=3,
    silhouette=bytes(6),
    box=Box(left=1, right=2, top=0, bottom=2),
    area_px=4,
    vote="flank",
    thresholds_px=(12.0, 19.5),
    measure=MEASURE,
    search=SEARCH,
    stick=FIT,
    landmarks=LANDMARKS,
)
REPORT = View(
    frame=7,
    captured_s=0.5,
    clock_s=1000.5,
    viewer=2,
    width=13,
    height=3,
    people=(PERSON,),
)


def seen(**said: Any) -> tuple[Observation, ...]:
    """The person with other things said of them."""
    return (msgspec.structs.replace(PERSON, **said),)


def searched(angles_deg: dict[str, float]) -> tuple[Observation, ...]:
    return seen(search=msgspec.structs.replace(SEARCH, angles_deg=angles_deg))


def of_person(**said: Any) -> View:
    return msgspec.structs.replace(REPORT, people=seen(**said))


GUIDE = Guide(
    frame=7,
    captured_s=0.5,
    clock_s=1000.5,
    frames=(7, 6),
    bdp=BDP,
    pose=tuple(rest_pose().tolist()),
    moves=(False, True),
    due=(None, 3),
)
BODY = Body(
    frame=7,
    captured_s=0.5,
    clock_s=1000.5,
    status="tracking",
    views="both",
    joints_m=((0.0, 1.0, 2.0),) * len(JOINT_NAMES),
    joints_px=(((1.0, 2.0),) * len(JOINT_NAMES),) * 2,
    pose=tuple(rest_pose().tolist()),
    angles_raw_deg=(1.0,) * len(ANGLE_NAMES),
    confidence=(0.5,) * len(JOINT_NAMES),
    extremities_m=((0.5, -1.0, 2.0),) * len(EXTREMITY_NAMES),
    extremities_px=(((3.5, -4.0),) * len(EXTREMITY_NAMES),) * 2,
    extremities_confidence=(0.0, 0.25, 1.0, 0.5, 0.5, 0.5, 0.5),
    bdp=BDP,
    moved=(2,),
)
LIFTING = Lifting("forward_left", 0.75, (0.5,) * len(LIMBS), (1.5,) * len(LIMBS))
LIFTED = msgspec.structs.replace(BODY, views="1", lifting=LIFTING)
LIES = Upright(REPORT.height, REPORT.width, 3, REPORT.height, REPORT.width)
"""Its file's picture lies on a side."""
SAID: list[Message] = [
    REPORT,
    msgspec.structs.replace(REPORT, people=()),
    of_person(measure=None, search=None, stick=None),
    msgspec.structs.replace(REPORT, people=(PERSON, PERSON, PERSON)),
    msgspec.structs.replace(REPORT, shift=Shift(right_px=3.5, down_px=-1.25, roll_deg=0.5)),
    msgspec.structs.replace(REPORT, upright=LIES),
    GUIDE,
    BODY,
    LIFTED,
    Posture(frame=7, captured_s=0.5, clock_s=0.5, name="squat", log_likelihoods={"squat": -9.5}),
    Picture(frame=7, captured_s=0.5, clock_s=0.5, viewer=1, jpeg=b"\xff\xd8"),
    Pulse(process="viewer 1", state="running", frames=7, fps=15.0),
    Command(what="measure"),
    Answer(what="save", well=True, text="15.0 s written"),
    Cameras(rig=paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0)), scale_source="calibrated"),
    Ended(viewer=1, frames=69),
    ClockQuestion(viewer=1, ready=True),
    ClockAnswer(now_s=1000.0, start_s=None),
]


def kinds() -> list[type[Message]]:
    """Every class of message that can be said: those that no other message is made from."""
    said = {**vars(messages), **vars(control_messages)}.values()
    found = [kind for kind in said if isinstance(kind, type)]
    return [kind for kind in found if issubclass(kind, Message) and kind not in (Message, Moment)]


@pytest.mark.parametrize("message", SAID, ids=lambda message: type(message).__name__)
def test_a_message_comes_back_as_it_was_said(message: Message) -> None:
    assert decode(encode(message), type(message)) == message


def test_every_kind_of_message_is_in_these_tests_and_has_a_topic() -> None:
    """Clock questions and answers are asked and given, not published."""
    known: set[type] = set(kinds())
    assert {type(message) for message in SAID} == known
    asked: set[type] = {ClockQuestion, ClockAnswer}
    assert asked == known - set(TOPICS)
    assert known >= set(TOPICS)


@pytest.mark.parametrize("message", SAID, ids=lambda message: type(message).__name__)
def test_a_listener_of_a_kind_hears_what_is_said_and_nothing_else(message: Message) -> None:
    kind = type(message)
    if kind not in TOPICS:
        return
    key = key_of(message, "hall")
    assert key.startswith("tritrack/hall/")
    assert matches(pattern_of(kind, "hall"), key)
    assert not any(matches(pattern_of(other, "hall"), key) for other in TOPICS if other is not kind)
    assert not matches(pattern_of(kind, "attic"), key)


def matches(pattern: str, key: str) -> bool:
    wanted, got = pattern.split("/"), key.split("/")
    return len(wanted) == len(got) and all(a in ("*", b) for a, b in zip(wanted, got, strict=True))


@pytest.mark.parametrize("message", SAID, ids=lambda message: type(message).__name__)
def test_a_message_cut_short_or_with_something_behind_it_is_refused(message: Message) -> None:
    payload = encode(message)
    for cut in (*range(min(len(payload), 40)), len(payload) - 1):
        with pytest.raises(MalformedMessage):
            decode(payload[:cut], type(message))
    with pytest.raises(MalformedMessage):
        decode(payload + b"\x00", type(message))


@pytest.mark.parametrize("message", SAID, ids=lambda message: type(message).__name__)
def test_a_message_is_taken_for_no_other_kind(message: Message) -> None:
    for kind in kinds():
        if kind is not type(message):
            with pytest.raises(MalformedMessage, match=kind.__name__):
                decode(encode(message), kind)


def test_a_message_of_another_protocol_is_refused() -> None:
    with pytest.raises(MalformedMessage, match=f"protocol {PROTOCOL + 1}, this is {PROTOCOL}"):
        decode(encode(msgspec.structs.replace(REPORT, protocol=PROTOCOL + 1)), View)


def test_a_message_of_more_than_a_megabyte_is_refused_unread() -> None:
    large = Picture(frame=0, captured_s=0.0, clock_s=0.0, viewer=1, jpeg=bytes(MAX_BYTES))
    with pytest.raises(MalformedMessage, match="bytes, at most"):
        decode(encode(large), Picture)


@pytest.mark.parametrize(
    "payload",
    [
        b"\x91" * 100_000,
        b"\x81\xa4pose" + b"\x91" * 100_000,
        b"\x81\xa6nobody" + b"\x81\xa1x" * 100_000,
        b"\xdd\xff\xff\xff\xff",
        encode(GUIDE).replace(b"\xa4pose\xdc", b"\xa4pose\xdd\xff\xff"),
    ],
    ids=["arrays in arrays", "in a field", "maps in maps", "four billion items", "a long field"],
)
def test_nesting_and_lengths_that_only_an_attacker_sends_are_refused(payload: bytes) -> None:
    with pytest.raises(MalformedMessage):
        decode(payload, Guide)


def floats_of(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where floats stand in builtins."""
    if isinstance(value, float):
        return [path]
    if isinstance(value, dict):
        return [found for key in value for found in floats_of(value[key], (*path, key))]
    if isinstance(value, list):
        return [found for n, item in enumerate(value) for found in floats_of(item, (*path, n))]
    return []


@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
@pytest.mark.parametrize("message", SAID, ids=lambda message: type(message).__name__)
def test_a_number_that_is_not_finite_is_refused_wherever_it_stands(
    message: Message, wrong: float
) -> None:
    """MessagePack carries NaN, and one of them would spread through every filter."""
    for path in floats_of(msgspec.msgpack.decode(encode(message))):
        told = msgspec.msgpack.decode(encode(message))
        place = told
        for step in path[:-1]:
            place = place[step]
        place[path[-1]] = wrong
        with pytest.raises(MalformedMessage):
            decode(msgspec.msgpack.encode(told), type(message))


@pytest.mark.parametrize(
    ("message", "field", "value", "says"),
    [
        (GUIDE, "pose", (0.0,) * (len(POSE_NAMES) - 1), "pose has 24 entries, not 25"),
        (BODY, "pose", (0.0,) * 26, "pose has 26 entries, not 25"),
        (BODY, "joints_m", ((0.0, 0.0, 0.0),) * 14, "joints_m has 14 entries, not 15"),
        (BODY, "joints_px", (((0.0, 0.0),) * 15,) * 9, "joints_px has 9 entries, not 8"),
        (BODY, "joints_px", (((0.0, 0.0),) * 15, ((0.0, 0.0),) * 14), "no 15 joints"),
        (BODY, "angles_raw_deg", (0.0,) * 16, "angles_raw_deg has 16 entries, not 17"),
        (BODY, "confidence", (1.0,), "confidence has 1 entries, not 15"),
        (REPORT, "people", seen(silhouette=bytes(5)), "silhouette has 5 bytes, not 6"),
        (REPORT, "people", seen(silhouette=bytes(7)), "silhouette has 7 bytes, not 6"),
        (REPORT, "people", seen(width=14), "a silhouette of 14x3 in a picture of 13x3"),
        (REPORT, "width", 0, "a picture of 0x3"),
        (REPORT, "height", -1, "a picture of 13x-1"),
        (REPORT, "people", searched({"tail_x": 1.0}), "unknown angle 'tail_x'"),
    ],
)
def test_a_wrong_length_is_refused_and_named(
    message: Message, field: str, value: object, says: str
) -> None:
    with pytest.raises(MalformedMessage, match=says):
        decode(encode(msgspec.structs.replace(message, **{field: value})), type(message))


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("joints_px", ((0.0, 0.0),) * 14, "joints_px has 14 entries, not 15"),
        ("ratios", (1.0,) * 11, "ratios has 11 entries, not 10"),
        ("hidden", (), "hidden has 0 entries, not 10"),
        ("ratios", (1.0,) * 9 + (1.1,), "shares beyond 0 to 1"),
        ("breadth", -0.1, "shares beyond 0 to 1"),
        ("score", 1.5, "shares beyond 0 to 1"),
        ("stature_px", 0.0, "of no stature"),
    ],
)
def test_a_stick_body_that_no_viewer_would_fit_is_refused(
    field: str, value: object, says: str
) -> None:
    report = of_person(stick=msgspec.structs.replace(FIT, **{field: value}))
    with pytest.raises(MalformedMessage, match=says):
        decode(encode(report), View)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("joints_px", ((1.0, 2.0),)),
        ("confidence", (0.5,)),
        ("confidence", (1.1,) * len(JOINT_NAMES)),
        ("confidence", (float("nan"),) * len(JOINT_NAMES)),
        ("second_px", ((1.0, 2.0),)),
        ("second_px", ()),
        ("second_confidence", (1.1,) * len(JOINT_NAMES)),
        ("facing_deg", 181.0),
        ("facing_confidence", -0.1),
    ],
)
def test_landmarks_that_no_source_tells_are_refused(field: str, value: object) -> None:
    told = msgspec.structs.replace(LANDMARKS, **{field: value})
    with pytest.raises(MalformedMessage):
        decode(encode(of_person(landmarks=told)), View)


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("depth_confidence", (0.5,) * 9, "depth_confidence has 9 entries, not 10"),
        ("depth_confidence", (), "depth_confidence has 0 entries, not 10"),
        ("depth_error_deg", (1.0,) * 11, "depth_error_deg has 11 entries, not 10"),
        ("orientation", "upwards", "unknown orientation 'upwards'"),
        ("orientation_confidence", 1.1, "confidences beyond 0 to 1"),
        ("depth_confidence", (0.5,) * 9 + (-0.1,), "confidences beyond 0 to 1"),
    ],
)
def test_a_lifting_that_no_integrator_would_decide_is_refused(
    field: str, value: object, says: str
) -> None:
    body = msgspec.structs.replace(
        LIFTED, lifting=msgspec.structs.replace(LIFTING, **{field: value})
    )
    with pytest.raises(MalformedMessage, match=says):
        decode(encode(body), Body)


def test_a_body_that_was_not_lifted_from_segments_has_no_errors_of_depth() -> None:
    lifting = msgspec.structs.replace(LIFTING, depth_error_deg=())
    body = msgspec.structs.replace(LIFTED, lifting=lifting)
    assert decode(encode(body), Body) == body


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("viewer", 0),
        ("viewer", 9),
        ("vote", "back"),
        ("frame", "7"),
        ("box", [1, 2, 0]),
        ("nonsense", 1),
    ],
)
def test_what_no_viewer_would_say_is_refused(field: str, value: object) -> None:
    told = msgspec.msgpack.decode(encode(REPORT)) | {field: value}
    with pytest.raises(MalformedMessage, match="no View"):
        decode(msgspec.msgpack.encode(told), View)


@given(st.sampled_from(kinds()), st.binary(max_size=300))
def test_no_bytes_raise_anything_but_malformed_message(kind: type[Message], payload: bytes) -> None:
    with pytest.raises(MalformedMessage):
        decode(payload, kind)


@given(st.sampled_from(SAID), st.data())
def test_a_message_with_bytes_changed_is_refused_or_still_a_message(
    message: Message, data: st.DataObject
) -> None:
    """Whatever happens on the way: the same kind comes out, finite, or MalformedMessage."""
    payload = bytearray(encode(message))
    for _ in range(data.draw(st.integers(1, 4))):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    try:
        got = decode(bytes(payload), type(message))
    except MalformedMessage:
        return
    assert type(got) is type(message)
    assert decode(encode(got), type(message)) == got


@given(shapes.arrays(np.bool_, shapes.array_shapes(min_dims=2, max_dims=2, max_side=70)))
def test_a_silhouette_comes_back_at_any_width(mask: np.ndarray[Any, np.dtype[np.bool_]]) -> None:
    height, width = mask.shape
    packed = pack(mask)
    assert len(packed) == height * ((width + 7) // 8)
    box = Box(0, width - 1, 0, height - 1)
    person = Observation(width=width, height=height, silhouette=packed, box=box, area_px=0)
    view = msgspec.structs.replace(REPORT, width=width, height=height, people=(person,))
    assert np.array_equal(mask_of(decode(encode(view), View)), mask)


@pytest.mark.parametrize(
    "box",
    [
        Box(left=-1, right=2, top=0, bottom=2),
        Box(left=2, right=1, top=0, bottom=2),
        Box(left=1, right=13, top=0, bottom=2),
        Box(left=1, right=2, top=2, bottom=0),
        Box(left=1, right=2, top=0, bottom=3),
    ],
    ids=["left of it", "from right to left", "right of it", "upside down", "below it"],
)
def test_a_box_that_is_not_in_the_picture_is_refused(box: Box) -> None:
    with pytest.raises(MalformedMessage, match="in a picture of 13x3"):
        decode(encode(of_person(box=box)), View)


@pytest.mark.parametrize(
    "wrong", [{"quarters": 4}, {"quarters": 2}, {"width": 0}, {"square_width": 7}], ids=str
)
def test_a_picture_that_was_turned_into_another_is_refused(wrong: dict[str, int]) -> None:
    report = msgspec.structs.replace(REPORT, upright=msgspec.structs.replace(LIES, **wrong))
    with pytest.raises(MalformedMessage, match="Upright"):
        decode(encode(report), View)


def test_a_body_with_a_pose_and_no_joints_is_refused() -> None:
    with pytest.raises(MalformedMessage, match="a pose without joints_m"):
        decode(encode(msgspec.structs.replace(BODY, joints_m=())), Body)


@pytest.mark.parametrize("frame", [2**62, -(2**62), 10**10])
def test_numbers_beyond_all_that_is_counted_are_refused(frame: int) -> None:
    with pytest.raises(MalformedMessage, match="frame holds"):
        decode(encode(msgspec.structs.replace(REPORT, frame=frame)), View)


def test_a_time_of_a_few_hundred_digits_is_refused() -> None:
    with pytest.raises(MalformedMessage, match="captured_s holds"):
        decode(encode(msgspec.structs.replace(REPORT, captured_s=1e200)), View)


def test_a_silhouette_of_the_papers_size_has_2400_bytes() -> None:
    """Section 2 of the design: 2.4 kB, and the whole report not much more."""
    packed = pack(np.ones((120, 160), np.bool_))
    assert len(packed) == 2400
    size = {"width": 160, "height": 120}
    people = seen(**size, silhouette=packed, stick=None, landmarks=None)
    assert len(encode(msgspec.structs.replace(REPORT, **size, people=people))) < 3500


@pytest.mark.parametrize(
    ("message", "field", "value", "says"),
    [
        (
            REPORT,
            "people",
            seen(measure=msgspec.structs.replace(MEASURE, height_px=0.0)),
            "without height or de",
        ),
        (
            REPORT,
            "people",
            seen(measure=msgspec.structs.replace(MEASURE, depth_px=0.0)),
            "without height or dep",
        ),
        (BODY, "extremities_m", ((0.0, 0.0, 0.0),) * 6, "extremities_m has 6 entries, not 7"),
        (BODY, "extremities_px", (((0.0, 0.0),) * 7,) * 9, "extremities_px has 9 entries, not 8"),
        (BODY, "extremities_px", (((0.0, 0.0),) * 6,), "extremities_px has no 7 places in a came"),
        (BODY, "extremities_confidence", (0.5,) * 8, "extremities_confidence has 8 entries, not"),
        (BODY, "moved", (1, 2, 1) * 3, "moved has 9 entries, not 8"),
        (BODY, "made_of", (), "made_of has 0 entries"),
        (GUIDE, "frames", (), "frames has 0 entries"),
        (GUIDE, "moves", (False,) * 3, "moves has no 2 entries"),
        (GUIDE, "pose", (1.0,) * 24 + (1.1e9,), r"pose holds 1100000000\.0, at most 1e\+09 is t"),
        (BODY, "joints_m", ((0.0, -1.1e9, 0.0),) * 15, r"joints_m holds -1100000000\.0, at most"),
        (REPORT, "people", searched({"r_shoulder_x": 2e9}), r"people holds 2000000000\.0"),
        (REPORT, "shift", Shift(0.0, 2e9, 0.0), r"shift holds 2000000000\.0"),
    ],
)
def test_what_no_body_has_is_refused_and_named(
    message: Message, field: str, value: object, says: str
) -> None:
    with pytest.raises(MalformedMessage, match=says):
        decode(encode(msgspec.structs.replace(message, **{field: value})), type(message))


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("joints_px", ((1.0, 2.0),) * 14, "joints_px has 14 entries, not 15"),
        ("confidence", (0.5,) * 16, "confidence has 16 entries, not 15"),
        ("extremities_px", ((1.0, 2.0),) * 6, "extremities_px has no 7 entries"),
        ("extremities_confidence", (0.5,) * 8, "extremities_confidence has no 7 entries"),
        ("extremities_px", (), "extremities without their confidence"),
        ("extremities_confidence", (0.5,) * 6 + (1.01,), "confidences beyond 0 to 1"),
        ("confidence", (-0.01,) + (0.5,) * 14, "confidences beyond 0 to 1"),
        ("second_px", ((1.0, 2.0),) * 14, "second_px has no 15 entries"),
        ("second_confidence", (0.5,) * 16, "second_confidence has no 15 entries"),
        ("second_confidence", (), "second places without their confidence"),
        ("second_confidence", (-0.01,) * 15, "confidences beyond 0 to 1"),
        ("facing_confidence", 1.01, "confidences beyond 0 to 1"),
        ("facing_deg", -180.5, "landmarks that face -180.5 degrees"),
    ],
)
def test_landmarks_are_refused_with_what_is_wrong(field: str, value: object, says: str) -> None:
    found = msgspec.structs.replace(LANDMARKS, **{field: value})
    with pytest.raises(MalformedMessage, match=says):
        decode(encode(of_person(landmarks=found)), View)


AT_THE_EDGE = {
    "a box of the whole picture": {"people": seen(box=Box(left=0, right=12, top=0, bottom=2))},
    "a box of one pixel": {"people": seen(box=Box(left=12, right=12, top=0, bottom=0))},
    "the turned picture": {"upright": LIES},
    "the least measure": {"people": seen(measure=msgspec.structs.replace(MEASURE, depth_px=1e-9))},
    "thirty years": {"captured_s": 1e9, "clock_s": -1e9},
    "a large sum": {"people": seen(thresholds_px=(6e8, 6e8))},
    "facing away": {"people": seen(landmarks=msgspec.structs.replace(LANDMARKS, facing_deg=180.0))},
    "the other way round": {
        "people": seen(landmarks=msgspec.structs.replace(LANDMARKS, facing_deg=-180.0))
    },
    "surely": {
        "people": seen(
            landmarks=msgspec.structs.replace(
                LANDMARKS, facing_confidence=1.0, second_confidence=(1.0,) * 15
            )
        )
    },
    "a lying stick body": {
        "people": seen(stick=msgspec.structs.replace(FIT, breadth=0.0, score=1.0, stature_px=1e-9))
    },
}


@pytest.mark.parametrize("change", AT_THE_EDGE.values(), ids=AT_THE_EDGE.keys())
def test_what_a_viewer_just_may_say_is_let_through(change: dict[str, Any]) -> None:
    report = msgspec.structs.replace(REPORT, **change)
    assert decode(encode(report), View) == report


def test_a_message_of_just_a_megabyte_is_looked_at() -> None:
    refuse_size(MAX_BYTES)
    with pytest.raises(MalformedMessage, match=r"^1000001 bytes, at most 1000000 are taken$"):
        refuse_size(MAX_BYTES + 1)
