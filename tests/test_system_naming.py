"""From a clip to its posture's name: the made-up person of the demo, and the same in a mirror."""

import shutil
import threading
import time
from pathlib import Path
from typing import Any

import cv2
import msgspec
import pytest
from local_bus import LocalBus

from common.body.body import ANGLES_IN_POSE, JOINT_NAMES, POSE_NAMES
from common.bus.control_messages import ClockAnswer, ClockQuestion, Pulse
from common.bus.inbox import Inbox
from common.bus.messages import Body, Performance, Posture
from common.bus.rate import Pace
from common.config.settings import Settings
from recognizer import __main__ as recognizer_process
from recognizer import events, spotting
from recognizer.__main__ import (
    SHIPPED,
    finish,
    init,
    model_of,
    row_of,
    run,
    step,
    warm_up,
    words,
)
from recognizer.events import Doing
from recognizer.model_file import ModelError, load
from recognizer.performance_judge import Event
from runtime.live.recorded import SoFar
from runtime.offline.lockstep import Decoders, track_clip


def tracked(clip: Path) -> list[Body]:
    with Decoders() as decoders:
        return list(track_clip(Settings(clip=str(clip)), decoders).bodies)


def told(bodies: list[Body]) -> list[Posture]:
    """What a live run would say of each."""
    state, postures = init(load(SHIPPED), 40), []
    for body in bodies:
        state, posture = step(state, body)
        postures.append(posture)
    return postures


def named(clip: Path) -> str:
    """What a live run of the clip would say at its end."""
    return SoFar(postures=told(tracked(clip))).posture


@pytest.fixture(scope="module")
def mirrored(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clip with camera 1's pictures turned left to right: the other arm is raised."""
    folder = tmp_path_factory.mktemp("mirrored") / clip.name
    shutil.copytree(clip, folder)
    shutil.copy(clip.parent / "calibration.json", folder)
    film = cv2.VideoCapture(str(clip / "cam1.avi"))
    size = (int(film.get(cv2.CAP_PROP_FRAME_WIDTH)), int(film.get(cv2.CAP_PROP_FRAME_HEIGHT)))
    code = cv2.VideoWriter.fourcc(*"MJPG")
    out = cv2.VideoWriter(str(folder / "cam1.avi"), code, 15.0, size)
    while True:
        more, picture = film.read()
        if not more:
            break
        out.write(cv2.flip(picture, 1))
    out.release()
    return folder


@pytest.mark.slow
def test_the_posture_is_named_of_a_person_that_no_model_was_trained_on(clip: Path) -> None:
    """P58: the demo's own answer."""
    assert named(clip) == "raise_right_lateral"


@pytest.mark.slow
def test_what_ends_with_the_clip_is_told_when_the_recognizer_ends(clip: Path) -> None:
    """By the process itself, after the last body: the arm is still up there."""
    bodies, bus, stop = tracked(clip), LocalBus(), threading.Event()
    bus.answer(ClockQuestion, lambda _: ClockAnswer(now_s=time.monotonic()))
    heard, pulses = bus.subscribe(Posture), bus.subscribe(Pulse)
    arguments = (load(SHIPPED), Settings(), bus, 1 / 15, stop)
    recognizer = threading.Thread(target=run, args=arguments)
    recognizer.start()
    postures: list[Posture] = []
    try:
        assert pulses.take(20.0) is not None, "it is ready"
        for body in bodies:
            bus.publish(body)
            last = heard.take(5.0)
            assert last is not None
            postures.append(last)
    finally:
        stop.set()
        recognizer.join()
    assert [posture.event for posture in postures if posture.event] == []
    (last,) = heard.drain()
    assert last.event is not None
    assert last.event.name == "raise_right_lateral"
    assert last.event.end == bodies[-1].frame
    assert (last.frame, last.captured_s) == (-1, bodies[-1].captured_s)


@pytest.mark.slow
def test_a_mirror_changes_the_answer(mirrored: Path) -> None:
    """The name comes from the pictures: it is not known beforehand."""
    assert named(mirrored) == "raise_left_lateral"


@pytest.mark.slow
@pytest.mark.parametrize(("gap_s", "goes_on"), [(0.9, True), (30.0, False)])
def test_what_comes_after_a_gap_in_time_is_another_motion(
    clip: Path, gap_s: float, goes_on: bool
) -> None:
    """Nothing was seen for half a minute, as while both cameras hung: no body tells of that."""
    bodies = tracked(clip)
    cut = next(n for n, posture in enumerate(told(bodies)) if posture.name)
    later = [
        msgspec.structs.replace(body, frame=body.frame + 900, captured_s=body.captured_s + gap_s)
        for body in bodies[cut + 1 :]
    ]
    first = told([*bodies[: cut + 1], *later])[cut + 1]
    assert bool(first.name) == goes_on
    assert (first.segment[0] < first.frame) == goes_on


@pytest.mark.slow
def test_a_camera_of_60_frames_a_second_shows_no_slow_motion(clip: Path) -> None:
    """P1: models count their own frames, 15 a second."""
    bodies = tracked(clip)
    quick = [
        msgspec.structs.replace(body, frame=4 * body.frame + n, captured_s=body.captured_s + n / 60)
        for body in bodies
        for n in range(4)
    ]
    slow, fast = told(bodies), told(quick)
    assert fast[-1].name == slow[-1].name == "raise_right_lateral"
    assert (fast[-1].doing, fast[-1].times) == (slow[-1].doing, slow[-1].times)


def a_body(frame: int) -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status="empty", views="both")


class Scripted:
    """Events in the place of those of a network, at the calls of `step` that they are told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, events_at: dict[int, Event]) -> None:
        self.call = -1

        def step(state: object, _row: object) -> tuple[object, Doing]:
            self.call += 1
            return state, Doing("", 0, events_at.get(self.call))

        monkeypatch.setattr(events, "step", step)
        monkeypatch.setattr(events, "finish", lambda _: events_at.get(-1))


def test_an_event_is_told_in_the_frames_and_seconds_of_the_stream(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its first and last count calls; the stream's frames begin at 700."""
    Scripted(monkeypatch, {30: Event("squat", 5, 25, 0.75, 2)})
    postures = told([a_body(700 + n) for n in range(40)])
    (event,) = [posture.event for posture in postures if posture.event]
    assert (event.onset, event.end) == (705, 725)
    assert (event.onset_s, event.end_s) == pytest.approx((47.0, 725 / 15))
    assert (event.name, event.posterior, event.times) == ("squat", 0.75, 2)
    assert words(event) == "47.0 to 48.3 s: squat, 2 times (75% sure)"
    once = msgspec.structs.replace(event, times=1)
    assert words(once) == "47.0 to 48.3 s: squat (75% sure)"


@pytest.mark.parametrize("last", [None, Event("squat", 1, 2, 0.9, 1)])
def test_a_run_ends_with_what_its_end_cuts_off_if_anything(
    monkeypatch: pytest.MonkeyPatch, last: Event | None
) -> None:
    """Each body is answered, and its delay is by the integrator's clock."""
    delays: list[float] = []
    monkeypatch.setattr(Pace, "done", lambda _, taken_s, now_s: delays.append(now_s - taken_s))
    Scripted(monkeypatch, {} if last is None else {-1: last})
    bus, stop = LocalBus(), threading.Event()
    bus.answer(ClockQuestion, lambda _: ClockAnswer(now_s=time.monotonic() + 100.0))
    heard, pulses = bus.subscribe(Posture), bus.subscribe(Pulse)
    given = [a_body(n) for n in range(3)]

    def take(inbox: Inbox[Body], _wait_s: float) -> Body | None:
        if given:
            return msgspec.structs.replace(given.pop(0), clock_s=time.monotonic() + 100.0)
        stop.set()
        return None

    monkeypatch.setattr(Inbox, "take", take)
    run(load(SHIPPED), Settings(), bus, 1 / 15, stop)
    said = heard.drain()
    assert [each.frame for each in said] == [0, 1, 2] + ([-1] if last else [])
    assert [each.event.name for each in said if each.event] == (["squat"] if last else [])
    assert len(delays) == 3
    assert max(map(abs, delays)) < 1.0
    beats = pulses.drain()
    assert beats[0].state == "ready"
    assert beats[-1].state == "ended"


def test_a_model_that_does_not_know_the_clips_posture_is_refused_by_name(tmp_path: Path) -> None:
    assert model_of(Settings()).names == load(SHIPPED).names
    assert model_of(Settings(mode="paper")).card.recognizer == "paper"
    assert model_of(Settings(), "squat").names == load(SHIPPED).names
    with pytest.raises(ModelError, match=r"other postures than 'handstand'.*squat"):
        model_of(Settings(), "handstand")
    copy = tmp_path / "mine.npz"
    shutil.copy(SHIPPED, copy)
    own = msgspec.structs.replace(Settings().recognizer, model=str(copy))
    with pytest.raises(ModelError, match=r"mine\.npz"):
        model_of(Settings(recognizer=own), "handstand")


def moving(frame: int, captured_s: float, status: Any = "tracking") -> Body:
    """A body that is followed; its right hip, knee and ankle make a leg of 0.8 m."""
    joints_m = [[0.0, 0.0, 0.0] for _ in JOINT_NAMES]
    for name, place in {"pelvis": (0.8, 1.2, 0.4), "r_knee": (0, -0.5, 0)}.items():
        joints_m[JOINT_NAMES.index(name)] = [float(each) for each in place]
    joints_m[JOINT_NAMES.index("r_ankle")] = [0.0, -0.5, 0.3]
    return msgspec.structs.replace(
        a_body(frame),
        captured_s=captured_s,
        status=status,
        pose=tuple(float(n) for n in range(len(POSE_NAMES))),
        joints_m=tuple(tuple(place) for place in joints_m),
    )


def test_a_row_is_of_who_moves_its_angles_and_its_place_in_leg_lengths() -> None:
    found = row_of(moving(0, 0.0))
    assert found is not None
    assert found[:17].tolist() == [float(n) for n in ANGLES_IN_POSE]
    assert found[17:] == pytest.approx([1.0, 1.5, 0.5])
    assert row_of(moving(0, 0.0, "predicted")) is not None
    for status in ("empty", "opening", "lost"):
        assert row_of(moving(0, 0.0, status)) is None
    assert row_of(msgspec.structs.replace(moving(0, 0.0), pose=())) is None


def counting(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What the window of judgements is given, frame by frame; it judges the last three."""
    given: list[Any] = []
    spotting_step = spotting.step

    def step(state: spotting.State, row: Any) -> Any:
        given.append(row)
        state, judged = spotting_step(state, row)
        last = state.next_frame - 1
        return state, judged._replace(name="squat", first=max(0, last - 2), last=last)

    monkeypatch.setattr(spotting, "step", step)
    return given


def test_a_gap_of_more_than_a_second_ends_what_was_going_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Then as many frames without a pose are told as end a motion; the clip goes on from there."""
    for gap_s, missed in ((0.99, 0), (1.01, spotting.MISSED_FRAMES)):
        given = counting(monkeypatch)
        state = init(load(SHIPPED), 40)
        state, _ = step(state, moving(3, 0.0))
        state, posture = step(state, moving(9, gap_s))
        assert sum(row is None for row in given) == missed
        assert posture.frame == 9
        monkeypatch.undo()


def test_segments_are_told_in_the_frames_of_the_stream_as_far_back_as_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A camera of 7.5 frames a second: each body stands for two of the models' frames, of which
    three are kept here."""
    counting(monkeypatch)
    monkeypatch.setattr(recognizer_process, "REACH_FRAMES", 3)
    state = init(load(SHIPPED), 40)
    segments = []
    for n in range(4):
        state, posture = step(state, moving(100 + n, n / 7.5))
        segments.append(posture.segment)
        assert len(state.frames) == min(3, 2 * n + 1)
    assert segments == [(100, 100), (100, 101), (101, 102), (102, 103)]
    assert recognizer_process._at(state, 0) == pytest.approx((102, 2 / 7.5))
    assert state.frames[-1] == pytest.approx((103, 3 / 7.5))


def test_the_papers_model_says_what_its_window_says(monkeypatch: pytest.MonkeyPatch) -> None:
    counting(monkeypatch)
    state, posture = step(init(model_of(Settings(mode="paper")), 40), moving(5, 0.2))
    assert (posture.name, posture.doing, posture.event) == ("squat", "squat", None)
    assert finish(state, posture) is None
    state, posture = step(init(load(SHIPPED), 40), moving(5, 0.2))
    assert (posture.name, posture.doing) == ("squat", "")


def test_what_a_step_runs_is_loaded_by_turning_bodies_long_enough_to_be_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = counting(monkeypatch)
    network: Any = []
    monkeypatch.setattr(events, "step", lambda state, row: (network.append(row) or state, None))
    warm_up(load(SHIPPED), 40)
    assert len(given) == len(network) == spotting.NAMED_FROM_FRAMES + 2
    assert [float(row[0]) for row in given[:3]] == [0.0, 9.0, 18.0]
    assert all((row == row[0]).all() for row in network)


def test_a_line_about_a_performance_says_whose_it_is_where_there_are_several() -> None:
    one = Performance(
        name="squat", onset=30, end=90, onset_s=2.0, end_s=6.0, posterior=0.93, times=2
    )
    assert words(one) == "2.0 to 6.0 s: squat, 2 times (93% sure)"
    assert words(one, 3) == "person 3, 2.0 to 6.0 s: squat, 2 times (93% sure)"
