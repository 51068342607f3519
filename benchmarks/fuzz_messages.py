"""What nobody says, said on every topic: refused with its reason, or taken in without harm.

Run from the checkout: .venv/bin/python benchmarks/fuzz_messages.py CLIP [--messages 1000000]
[--steps 50000] [--seed 0]

Every message that a clip gives rise to is damaged, byte by byte or value by value, and decoded. Of
those that are taken for a message some are handed to the step that would hear them, in the state
that the honest ones before left: reports to the integrator, bodies to the recogniser, guides to a
viewer, commands to the integrator. Ends with exit code 1 where anything else than a refusal came.
"""

import argparse
import faulthandler
import os
import sys
import time
import traceback
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import msgspec
import numpy as np
import psutil
from mutations import damaged, strange
from rich.console import Console

import recognizer.__main__ as recogniser
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
from common.bus.instant import Instant
from common.bus.message_codec import TOPICS, decode, encode
from common.bus.messages import Body, Guide, Message, Picture, View
from common.config.config_file import load
from common.method import METHODS
from common.rig.camera import Rig
from common.video.clips import open_clip
from integrator import commands, diagnostics, merge, merge_state, pairing
from integrator.frame_numbers import frame_times
from integrator.merge_state import Start
from integrator.pairing import with_item
from integrator.single.sight import Annotations
from runtime.live.table import table_of_rows
from runtime.offline.frame_pairs import openings
from runtime.offline.lockstep import Decoders, track_clip
from runtime.offline.performance import Watch
from runtime.steps.frame_cache import FrameCache
from viewer import track

WORDS = ("refused", "taken", "handed on", "harm")
KINDS: tuple[type[Message], ...] = (*TOPICS, ClockQuestion, ClockAnswer)


class Honest(NamedTuple):
    """What was said, and the states that it left."""

    said: dict[type[Message], list[tuple[int, bytes]]]
    """Of each kind: at which instant, and the bytes."""
    pairs: list[Instant]
    integrator: list[merge_state.State]
    recogniser: list[recogniser.State]
    viewer: track.State
    frame: Any


def honest(path: Path) -> Honest:
    """A clip followed once."""
    settings = load(path)
    method = METHODS[settings.mode]
    heard: list[tuple[dict[int, Any], dict[int, View], Body]] = []
    with Decoders() as decoders:
        track_clip(
            settings, decoders, watch=Watch(lambda *instant: heard.append(instant), heard.clear)
        )
        clip = open_clip(settings, decoders.of[1])
        assert clip.rig is not None, f"{path} has no calibration"
        frame_caches = {view.number: FrameCache(decoders.of[view.number]) for view in clip.views}
        background = openings(clip, settings.silhouette, frame_caches)[0].background
    setup = track.Setup(1, clip.rig.cameras[0], settings, method, alone=False)
    viewer = track.init(setup, background)
    start = Start(alone=False, times=frame_times(clip))
    state = merge_state.init(clip.rig, clip.every / clip.views[0].fps, settings, method, start)
    model = recogniser.model_of(settings)
    judged = recogniser.init(model, settings.recognizer.window_frames)
    found = Honest({kind: [] for kind in KINDS}, [], [], [], viewer, heard[9][0][1])
    for i, (_, reports, _) in enumerate(heard):
        pair = Instant((reports.get(1), reports.get(2)))
        found.pairs.append(pair)
        found.integrator.append(state)
        found.recogniser.append(judged)
        state, body, guide = merge.step(state, pair)
        judged, posture = recogniser.step(judged, body)
        for message in (*reports.values(), body, guide, posture, *others(clip.rig)):
            found.said[type(message)].append((i, encode(message)))
    return found


def others(rig: Rig) -> tuple[Message, ...]:
    """One message of each kind that a clip does not give rise to."""
    return (
        Pulse(process="viewer 1", state="running", frames=9, fps=15.0),
        Cameras(rig=rig, scale_source="calibrated"),
        Ended(viewer=1, frames=9),
        Command(what="front"),
        Answer(what="front", well=True, text="said"),
        ClockQuestion(viewer=1, ready=True),
        ClockAnswer(now_s=99.0, start_s=100.0),
        Picture(frame=0, captured_s=0.0, clock_s=0.0, viewer=1, jpeg=bytes(99)),
    )


def heard(known: Honest, at: int, message: Message) -> None:
    """Hand a message to who would hear it."""
    if isinstance(message, View):
        _, complete = pairing.step(pairing.init(1 / 15, (message.viewer,)), message)
        forged = Instant(with_item(known.pairs[at].views, message.viewer - 1, message))
        after, _, _ = merge.step(known.integrator[at], forged)
        merge.step(after, known.pairs[min(at + 1, len(known.pairs) - 1)])
        person = diagnostics.Present(0, complete[0].detections, measured=False)
        diagnostics.step(diagnostics.State(), complete[0], [person])
    elif isinstance(message, Body):
        judged, _ = recogniser.step(known.recogniser[at], message)
        recogniser.step(judged, message)
    elif isinstance(message, Guide):
        track.step(known.viewer, known.frame, message)
    elif isinstance(message, Command):
        commands.step(known.integrator[at], Annotations(), message)


def main() -> None:
    cv2.setNumThreads(1)
    faulthandler.enable()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clip", type=Path, help="a calibrated clip folder")
    parser.add_argument("--messages", type=int, default=1_000_000)
    parser.add_argument("--steps", type=int, default=50_000, help="that are handed on, at most")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    known, random = honest(given.clip), np.random.default_rng(given.seed)
    counts = {kind: Counter[str]() for kind in KINDS}
    every = max(1, given.messages // given.steps // 2)
    slowest_s, memory, before_mb = 0.0, psutil.Process(), 0.0
    for n in range(given.messages):
        kind = KINDS[n % len(KINDS)]
        began_s = time.process_time()
        counts[kind].update(fuzzed(known, kind, random, hands_on=n // len(KINDS) % every == 0))
        slowest_s = max(slowest_s, time.process_time() - began_s)
        if n == given.messages // 10:
            before_mb = memory.memory_info().rss / 1e6
    rows = [
        {"name": kind.__name__, **{word: counts[kind][word] for word in WORDS}} for kind in KINDS
    ]
    Console().print(table_of_rows(rows))
    grown_mb = memory.memory_info().rss / 1e6 - before_mb
    print(f"slowest {1e3 * slowest_s:.0f} ms; grown by {grown_mb:.0f} MB since the first tenth")
    sys.exit(1 if any(count["harm"] for count in counts.values()) else 0)


def fuzzed(
    known: Honest, kind: type[Message], random: np.random.Generator, hands_on: bool
) -> list[str]:
    """One message damaged and said; what became of it, of WORDS."""
    at, whole = known.said[kind][random.integers(len(known.said[kind]))]
    if random.random() < 0.5:
        payload = damaged(random, whole)
    else:
        payload = msgspec.msgpack.encode(strange(random, msgspec.msgpack.decode(whole)))
    try:
        message = decode(payload, kind)
        if payload == whole or not hands_on:
            return ["taken"]
        heard(known, at, message)
    except MalformedMessage:
        return ["refused"]
    except Exception as error:
        _tell(kind, payload, error)
        return ["harm"]
    return ["taken", "handed on"]


def _tell(kind: type[Message], payload: bytes, error: Exception) -> None:
    where = traceback.extract_tb(error.__traceback__)[-1]
    print(f"{kind.__name__}: {error!r} at {where.filename}:{where.lineno}, of {payload!r:.2000}")


if __name__ == "__main__":
    main()
