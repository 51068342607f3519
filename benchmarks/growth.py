"""How the time of a frame pair grows with the picture, and that of a search with its hypotheses.

Run from the checkout; writes a picture and prints the figures as JSON:

    .venv/bin/python benchmarks/growth.py --out growth.png [--repeats 5]
"""

import argparse
import json
import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

from common.body.body import POSE_INDEX, rest_pose
from common.body.kinematics import ARM_LIMBS
from common.body.proportions import LOWER_LEG_HEIGHT, UPPER_LEG_HEIGHT, body_vector, thesis_bdp
from common.config.settings import Settings
from common.raster.bits import count, pack_words
from common.raster.kernel import draw_body, view_of
from integrator.fit.silhouette_pair import products
from lab.bench.bench import PERFORMER_SEED, machine
from runtime.offline.lockstep import Decoders, track_clip
from synth.picture.exposure import default_rig
from synth.write import ClipSet, write_set

SIZES = ((160, 120), (320, 240), (640, 480))
HYPOTHESES = (1, 4, 16, 64, 256)
STAGES = ("preparation", "viewers", "integrator")


def tracking(repeats: int) -> dict[str, dict[str, float]]:
    """Milliseconds a frame pair of `track` in default mode by stage, at every size: the least."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="tritrack-growth-") as folder, Decoders() as decoders:
        wanted = ClipSet("postures", seed=PERFORMER_SEED, postures=("walk_in_place",))
        clip = write_set(Path(folder), wanted, SIZES[-1])[0]
        for width, height in SIZES:
            settings = Settings(clip=str(clip), size=f"{width}x{height}")
            runs = [track_clip(settings, decoders) for _ in range(repeats + 1)][1:]
            found[settings.size] = {
                stage: 1e3 * min(run.facts["seconds"][stage] for run in runs) / len(runs[0].bodies)
                for stage in (*STAGES, "all")
            }
    return found


def searching(repeats: int) -> dict[str, list[float]]:
    """Microseconds in which both views judge poses that differ in an arm, at every size."""
    return {f"{w}x{h}": [_judged_us(w, h, n, repeats) for n in HYPOTHESES] for w, h in SIZES}


def _judged_us(width: int, height: int, hypotheses: int, repeats: int) -> float:
    rig, body = default_rig(width, height), body_vector(thesis_bdp(1.75))
    views = np.array([view_of(camera) for camera in rig.cameras])
    poses = np.tile(rest_pose(), (hypotheses, 1))
    poses[:, POSE_INDEX["y"]] = body[UPPER_LEG_HEIGHT] + body[LOWER_LEG_HEIGHT]
    poses[:, POSE_INDEX["r_shoulder_x"]] = np.linspace(0.0, 90.0, hypotheses)
    limbs = sum(1 << limb for limb in ARM_LIMBS[0])
    seen = np.array(
        [pack_words(draw_body(body, poses[0], view, (width, height))) for view in views]
    )
    seen_px = np.array([count(each) for each in seen])
    return _least_us(lambda: products(body, poses, limbs, views, seen, seen_px, width), repeats)


def _least_us(run: Callable[[], object], repeats: int) -> float:
    run()
    least_s = float("inf")
    for _ in range(40 * repeats):
        began_s = time.perf_counter()
        run()
        least_s = min(least_s, time.perf_counter() - began_s)
    return 1e6 * least_s


def plot(found: dict[str, dict[str, float]], judged: dict[str, list[float]], out: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.4, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = [f"{size}\n{1e3 / told['all']:.0f} a second" for size, told in found.items()]
    parts = {stage: np.array([told[stage] for told in found.values()]) for stage in STAGES}
    whole = np.array([told["all"] for told in found.values()])
    parts["decoding, waiting"] = np.maximum(whole - sum(parts.values()), 0.0)
    floor = np.zeros(len(found))
    for stage, height in parts.items():
        left.bar(names, height, bottom=floor, label=stage)
        floor += height
    left.set(ylabel="ms a frame pair", title="track, default mode, by picture")
    left.legend()
    for size, times_us in judged.items():
        right.loglog(HYPOTHESES, times_us, "o-", label=size)
    right.set(xlabel="poses", ylabel="us", title="poses judged in both views, an arm differing")
    right.legend()
    figure.savefig(out, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--out", type=Path, default=Path("growth.png"))
    parser.add_argument("--repeats", type=int, default=5)
    given = parser.parse_args()
    found, judged = tracking(given.repeats), searching(given.repeats)
    plot(found, judged, given.out)
    told = {"machine": machine(), "ms_a_pair": found, "hypotheses": HYPOTHESES, "us": judged}
    print(json.dumps(told, indent=1))


if __name__ == "__main__":
    main()
