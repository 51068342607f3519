"""A recorded run replayed: its reports through the integrator, or all its messages onto a bus."""

import threading
import time
from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from itertools import chain, groupby
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
from rich.console import Console

from common.bus.bus import Bus, open_hub
from common.bus.control_messages import Cameras
from common.bus.instant import Instant
from common.bus.message_codec import encode
from common.bus.messages import Body, Message, Moment, View
from common.bus.rate import wait_until
from common.config.part_settings import BusSettings
from common.method import METHODS
from common.npz_file import Facts
from integrator import merge_state
from integrator.live_rig.rig_change import set_back, with_rig
from integrator.measuring import opening_posture
from integrator.merge_state import Start
from integrator.people import recognition, several
from runtime.store.other_run import refuse_other, run_of
from runtime.store.recording import Recording, read_recording
from runtime.store.runs import write_run

LISTEN_S: Final = 1.0
"""Time for subscribers to connect before the first message, seconds."""


class Replayed(NamedTuple):
    """The result of integrating recorded reports."""

    bodies: list[Body]
    same: int
    """Number of bodies that equal the recorded ones, byte for byte."""
    scale_source: str


def replay_run(folder: Path, out: Path | None, force: bool = False) -> Facts:
    """Send a run's recorded reports through the integrator again.

    Args:
        folder: The run's folder.
        out: Folder for the result as a run of its own; None: nothing is written.
        force: A run of another source may be overwritten.

    Raises:
        RecordingError: When there is no recording.
        RunError: When `out` cannot be written.
        OtherRun: When it holds a run of another source.
    """
    now = run_of("replay", [str(folder)])
    if out is not None and not force:
        refuse_other(out, now)
    recording = read_recording(folder)
    done = integrated(recording)
    facts = {"clip": recording.head.name, "bodies": len(done.bodies), "same": done.same}
    if out is not None:
        told = {**facts, "scale_source": done.scale_source, "warnings": [], **now.facts}
        told["cameras"] = [*recording.head.cameras]
        write_run(out, done.bodies, recording.head.settings, told)
    return facts


def integrated(recording: Recording) -> Replayed:
    """The bodies from the recorded reports, at the recorded instants."""
    head = recording.head
    opening = opening_posture.init(head.body)
    room = merge_state.init(
        head.rig,
        head.period_s,
        head.settings,
        METHODS[head.settings.mode],
        Start(head.alone, head.scale_source, opening, head.times, head.by_person),
    )
    state = recognition.State(room)
    rigs = {told.calibration: told.rig for told in recording.cameras}
    bodies: list[Body] = []
    same = 0
    for before, instant in instants(recording):
        calibration = before[0].calibration
        if calibration > state.room.calibration and calibration in rigs:
            state = several.with_room(state, with_rig(state.room, rigs[calibration]))
        state, merged = several.step(state, instant)
        bodies += merged.bodies
        recorded = {encode(body) for body in before}
        same += sum(encode(body) in recorded for body in merged.bodies)
    return Replayed(bodies, same, state.room.scale_source)


def instants(recording: Recording) -> Iterator[tuple[list[Body], Instant]]:
    """The recorded bodies of each instant, one of each person, with the reports that they were
    made of, if none of these is lost."""
    each = [_by_frame(reports) for reports in recording.reports]
    late_s = {told.calibration: told.late_s for told in recording.cameras}
    tolerance_s = 0.5 * recording.head.period_s
    for _, people in groupby(recording.bodies, _instant_of):
        bodies = list(people)
        body = bodies[0]
        late = late_s.get(body.calibration, 0.0)
        now = []
        for by_frame, frame in zip(each, body.made_of, strict=False):
            told = [set_back(report, late) for report in by_frame[frame]]
            now.append(_near(told, body, tolerance_s))
        found = tuple(-1 if report is None else report.frame for report in now)
        if found == body.made_of and any(report is not None for report in now):
            yield bodies, Instant(tuple(now))


def _instant_of(body: Body) -> tuple[float, tuple[int, ...], int]:
    """What the bodies of an instant share."""
    return body.captured_s, body.made_of, body.calibration


def _by_frame(reports: Sequence[View]) -> defaultdict[int, list[View]]:
    """A restarted viewer may count its frames anew."""
    by_frame = defaultdict[int, list[View]](list)
    for report in reports:
        by_frame[report.frame].append(report)
    return by_frame


def _near(reports: Sequence[View], body: Body, tolerance_s: float) -> View | None:
    """The last report captured when the body was."""
    near = [r for r in reports if abs(r.captured_s - body.captured_s) <= tolerance_s + 1e-9]
    return near[-1] if near else None


def replay_on_bus(folder: Path, bus_settings: BusSettings, speed: float, console: Console) -> Facts:
    """Publish all messages of a recorded run again, at its pace, at an endpoint.

    Messages are as recorded except for `clock_s`, the time of publication.

    Args:
        folder: The run's folder.
        bus_settings: Where others connect, and the keys.
        speed: 2.0 is twice as fast.
        console: Shows the endpoint.

    Raises:
        RecordingError: When there is no recording.
        BusError: When the endpoint is taken or is none.
        KeysError: When the named keys do not exist.
    """
    recording = read_recording(folder)
    room = recording.head.settings.room
    with open_hub(bus_settings, room) as bus:
        bus.keep(Cameras)
        bus.announce("integrator")  # in the integrator's name: subscribers end when it leaves
        console.print(
            f"{recording.head.name}: room {room} at {bus_settings.endpoint}", highlight=False
        )
        time.sleep(LISTEN_S)
        said = say(recording, bus, speed)
        time.sleep(LISTEN_S)
    return {"clip": recording.head.name, "said": said}


def say(recording: Recording, bus: Bus, speed: float) -> int:
    """Publish all messages at their pace, each rig before the bodies computed with it; returns
    their number."""
    rigs = deque(_rigs(recording))
    moments: list[Moment] = [*chain.from_iterable(recording.reports)]
    moments += [*recording.bodies, *recording.postures]
    moments.sort(key=lambda message: message.captured_s)  # stable sort: reports, body, posture
    begin_s, stop = time.monotonic(), threading.Event()
    first_s = moments[0].captured_s if moments else 0.0
    said = calibration = 0
    for message in moments:
        wait_until(begin_s + (message.captured_s - first_s) / speed, stop)
        if isinstance(message, Body):
            calibration = message.calibration
        while rigs and rigs[0].calibration <= calibration:
            bus.publish(rigs.popleft())
            said += 1
        bus.publish(_now(message))
        said += 1
    return said


def _rigs(recording: Recording) -> list[Cameras]:
    """The rigs of a run in order; one that was known before it is in the header alone."""
    head, told = recording.head, recording.cameras
    if head.rig is None or any(cameras.calibration == 0 for cameras in told):
        return told
    return [Cameras(rig=head.rig, scale_source=head.scale_source or "calibrated"), *told]


def _now(message: Moment) -> Message:
    return msgspec.structs.replace(message, clock_s=time.monotonic())
