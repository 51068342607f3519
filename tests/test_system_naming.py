"""From a clip to its posture's name: the made-up person of the demo, and the same in a mirror."""

import shutil
import threading
import time
from pathlib import Path

import cv2
import msgspec
import pytest
from local_bus import LocalBus

from common.bus.control_messages import ClockAnswer, ClockQuestion, Pulse
from common.bus.messages import Body, Posture
from common.config.settings import Settings
from recognizer.__main__ import SHIPPED, init, run, step
from recognizer.model_file import load
from tritrack.live.recorded import SoFar
from tritrack.offline.lockstep import Decoders, track_clip


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


def test_the_posture_is_named_of_a_person_that_no_model_was_trained_on(clip: Path) -> None:
    """P58: the demo's own answer."""
    assert named(clip) == "raise_right_lateral"


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


def test_a_mirror_changes_the_answer(mirrored: Path) -> None:
    """The name comes from the pictures: it is not known beforehand."""
    assert named(mirrored) == "raise_left_lateral"


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
