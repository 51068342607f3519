"""Walks whose second view is late by -6 to 6 s: how often that is found, ambiguous, or wrong.

    .venv/bin/python benchmarks/late_views.py --clips $TRITRACK_DATA/dev/r07_t1_0[1-4]* --seeds 12

A camera that was started later lacks the beginning; either is cut. Of clips that are named the
landmarks are looked for once and cut, as frames would be. Made-up walks are geometry alone
(`wild_rigs.py`): half begin with a T, half are steps from first to last.
"""

import argparse
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Final, Literal, NamedTuple

import msgspec
import numpy as np
from wild_rigs import AT, Film, random_pair, seen

from calibration.tracks.joint_tracks import JointTrack, Sighting
from calibration.tracks.lateness import clock_of
from common.config import config_file
from common.method import METHODS
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import Reader
from runtime.offline.rig_from_person import sightings_of
from runtime.steps.frame_cache import FrameCache
from synth.motion.motions import performance
from synth.person.people import person
from viewer.landmarks.landmark_sources import outside_sources

OFFSETS_S: Final = np.arange(-6.0, 7.0)
WALKS: Final = ("walk_in_place", "walk_sideways", "walk_toward", "walk_slow_bigswing")
RATES_HZ: Final = (15.0, 25.0, 30.0)
LASTS_S: Final = (8.0, 12.0, 16.0)
OPENING_S: Final = 1.6
WITHIN: Final = 0.5
"""Frames within which a lateness is right."""
Word = Literal["found", "ambiguous", "unknown", "wrong"]


class Shown(NamedTuple):
    """A walk that both views show from first to last, on time."""

    name: str
    sighting: Sighting


def looked_at(paths: list[Path], size: str) -> Iterator[Shown]:
    """The walks of clips."""
    with ExitStack() as doors:
        decoders: list[Reader] = [doors.enter_context(Decoder()) for _ in range(2)]
        for path in paths:
            settings = msgspec.structs.replace(config_file.load(path), size=size)
            clip = open_clip(settings)
            readers = {view.number: FrameCache(decoders[view.number - 1]) for view in clip.views}
            with outside_sources(settings, clip.views) as sources:
                method = METHODS["default"]
                yield Shown(
                    path.name, sightings_of(clip, settings, method, readers, sources).pair(0, 1)
                )


def made_up(first: int, count: int) -> Iterator[Shown]:
    """Walks of made-up people before random cameras."""
    for seed in range(first, first + count):
        rng, someone = np.random.default_rng([seed, 99]), person(seed)
        hz, posture = RATES_HZ[seed % 3], WALKS[seed % 4]
        motion = performance(someone, posture, seed, hz, LASTS_S[seed // 2 % 3])
        joints_m = motion.joints_m[motion.present][:, AT]
        joints_m = joints_m[round(OPENING_S * hz) if seed % 2 else 0 :]
        rig = random_pair(rng, someone.measures["stature_m"])
        film = Film(joints_m, np.ones(len(joints_m), bool), hz)
        yield Shown(f"{seed} {posture} {hz:.0f} Hz", seen(film, rig, 0.0, rng))


def started_later(track: JointTrack, frames: int) -> JointTrack:
    """What a camera shows that was started so many frames later, by its own times."""
    rest = JointTrack(*(part[frames:] for part in track))
    return rest._replace(times_s=rest.times_s - rest.times_s[:1])


def judged(shown: Sighting, offset_s: float) -> Word:
    """What is told of a view 2 that is late by so much."""
    period_s = float(np.median(np.diff(shown.first.times_s)))
    frames = round(offset_s / period_s)
    late = shown._replace(
        first=started_later(shown.first, max(frames, 0)),
        second=started_later(shown.second, max(-frames, 0)),
    )
    clock = clock_of(late)
    off_s = abs(clock.late_s - frames * period_s)
    is_right = off_s <= WITHIN * period_s
    if clock.state == "found" and not is_right:
        print(f"off by {off_s / period_s:.2f} frames")
    return clock.state if clock.state != "found" or is_right else "wrong"


def main() -> None:
    """Print a row for each offset."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clips", type=Path, nargs="*", default=[])
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--seeds", type=int, default=0)
    parser.add_argument("--first-seed", type=int, default=5000)
    given = parser.parse_args()
    rows: dict[float, Counter[Word]] = {offset_s: Counter() for offset_s in OFFSETS_S.tolist()}
    for name, sighting in (
        *looked_at(given.clips, given.size),
        *made_up(given.first_seed, given.seeds),
    ):
        for offset_s, told in rows.items():
            word = judged(sighting, offset_s)
            told[word] += 1
            if word == "wrong":
                print(f"wrong: {name}, {offset_s:+.1f} s")
    for offset_s, told in rows.items():
        print(f"{offset_s:+.1f} s  " + "  ".join(f"{word} {n}" for word, n in sorted(told.items())))
    print(f"wrong in all: {sum(told['wrong'] for told in rows.values())}")


if __name__ == "__main__":
    main()
