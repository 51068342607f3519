"""A live run without a calibration against the same clip offline, in lock-step.

    python benchmarks/live_rig.py CLIP...

CLIP has a truth (`benchmarks/joined_clips.py` makes long ones). What the person tells comes
WAIT_S after it is asked for; the real processes need 3 s on a quiet machine. Told are the mean
error in the world as published, and the share of frames with a joint more than 200 mm off, of the
instants later than AFTER_S.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from threadpoolctl import threadpool_limits

from common.body.body import JOINT_NAMES
from common.bus.instant import Instant, first_two
from common.bus.messages import Body, Guide, View
from common.config.part_settings import BodySettings
from common.config.settings import Settings
from common.method import METHODS
from common.video.clips import open_clip
from integrator import merge, merge_state
from integrator.live_rig import rig_search
from integrator.live_rig.rig_change import set_back, with_rig
from integrator.live_rig.rig_job import Solution, solved
from integrator.merge_state import Start
from runtime.offline.frame_pairs import instants, openings
from runtime.offline.lockstep import Decoders, track_clip
from viewer import track
from viewer.landmarks.landmark_sources import outside_sources

WAIT_S: Final = 3.0
AFTER_S: Final = 10.0
JOINTS: Final = [n for n, name in enumerate(JOINT_NAMES) if "_" in name and name != "head_top"]


def live_bodies(settings: Settings, decoders: Decoders) -> list[Body]:
    """The bodies of a run that looks for its rig, told when it changes."""
    method = METHODS[settings.mode]
    clip = msgspec.structs.replace(open_clip(settings, decoders.of[1]), rig=None)
    period_s = clip.every / clip.views[0].fps
    learnt = openings(clip, settings.silhouette, decoders.of)
    setups = {view.number: track.Setup(view.number, None, settings, method) for view in clip.views}
    viewers = {
        number: track.init(setup, opening.background)
        for (number, setup), opening in zip(setups.items(), learnt, strict=True)
    }
    state = merge_state.init(None, period_s, settings, method, Start(by_person=True))
    search = rig_search.init(period_s, settings.body.stature_m)
    guide: Guide | None = None
    bodies: list[Body] = []
    coming: list[tuple[float, Solution]] = []
    with outside_sources(settings, clip.views) as sources:
        for frames in instants(clip, decoders.of, sources):
            reports: dict[int, View] = {}
            for number, frame in frames.items():
                viewers[number], report = track.step(viewers[number], frame, guide)
                reports[number] = set_back(report, search.late_s)
            pair = Instant((reports.get(1), reports.get(2)))
            state, body, guide = merge.step(state, pair)
            bodies.append(body)
            search, job = rig_search.step(search, first_two(pair.views))
            if job is not None:
                coming.append((body.captured_s + WAIT_S, solved(job)))
            if coming and body.captured_s >= coming[0][0]:
                search, taken = rig_search.answered(search, coming.pop(0)[1])
                if taken is not None:
                    state = with_rig(state, taken.rig)
                    print(f"  {body.captured_s:.1f} s: rig {state.calibration}")
    return bodies


def told(bodies: Sequence[Body], truth: Path) -> str:
    """How far off they are."""
    with np.load(truth) as known:
        names, real = known["joint_names"].tolist(), known["joints3d"]
    real = real[:, [names.index(JOINT_NAMES[n]) for n in JOINTS]]
    late = [body for body in bodies if body.joints_m and body.captured_s >= AFTER_S]
    off_m = np.stack(
        [np.linalg.norm(np.array(b.joints_m)[JOINTS] - real[b.frame], axis=-1) for b in late]
    )
    return f"{1e3 * off_m.mean():.1f} mm, lost {(off_m > 0.2).any(axis=1).mean():.1%}"


if __name__ == "__main__":
    with threadpool_limits(1), Decoders() as opened:
        for folder in map(Path, sys.argv[1:]):
            stature_m = msgspec.json.decode((folder / "meta.json").read_bytes())["measures"]
            of_run = Settings(clip=str(folder), body=BodySettings(stature_m["stature_m"]))
            print(folder.name)
            print("  live:", told(live_bodies(of_run, opened), folder / "truth.npz"))
            offline = track_clip(of_run, opened).bodies
            print("  offline:", told(offline, folder / "truth.npz"), flush=True)
