"""What a dance takes by hand, and what it lacks when nobody helps: the thesis's ledger (T24).

Run from the checkout: .venv/bin/python benchmarks/dancing_effort.py [--performer 900] [--json]

A synthetic dance of 200 frames with seven turns, of which `tritrack single` sees camera 1 alone.
Inputs that would put it right are counted against the truth: a joint is where it should be within
6 % of the body's height in the picture (issue 5, Shows 3).
"""

import argparse
import json
import os
import tempfile
from pathlib import Path
from typing import Any, Final

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import msgspec
import numpy as np
from dancing import dance, faced
from rich.console import Console

from animator.take import Take, depth_of, take_of
from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS
from common.config.settings import Settings
from common.rig.camera import Rig, project
from synth.motion.motions import Motion
from synth.person.people import person
from synth.person.skeleton import JOINTS
from synth.picture.exposure import default_rig
from synth.write import Filming, write_clip
from tritrack.single.ledger import PRINTED, Count, inputs, stretches
from tritrack.single.single import Given, single_all

NEAR: Final = 0.06
"""Of the body's height in the picture."""


def truth_of(motion: Motion, rig: Rig) -> Take:
    """What a run without an error would say of the dance, sure of all."""
    n = len(motion.phase)
    joints_m = motion.joints_m[:, [JOINTS.index(name) for name in JOINT_NAMES]]
    pixels = project(rig.cameras[0], joints_m.reshape(-1, 3)).reshape(n, 1, len(JOINT_NAMES), 2)
    return take_of(
        {
            "frame": np.arange(n),
            "joints_px": pixels,
            "joints_m": joints_m,
            "confidence": np.ones((n, len(JOINT_NAMES))),
            "orientation": faced(motion),
        }
    )


def mending_inputs(take: Take, truth: Take, near_px: float) -> Count:
    """The inputs that would put right what is wrong, where the truth is known.

    A user who knows it says the orientation where another was taken, the direction of a segment
    that leans the other way or not at all, and the place of the joint at its far end where that
    is off; each as long as it holds (T21).

    Args:
        take: The run.
        truth: The same frames.
        near_px: A joint that is off by less is where it should be.
    """
    posed = take.posed & truth.posed
    lean, true_lean = depth_of(take.joints_m), depth_of(truth.joints_m)
    wrong = posed[:, None] & (true_lean != 0) & (lean != true_lean)
    far = LIMB_ENDS[:, 1]
    off_px = np.linalg.norm(take.joints_px[:, far] - truth.joints_px[:, far], axis=2)
    misplaced = posed[:, None] & (off_px > near_px)
    return Count(
        orientation=inputs(truth.orientation, posed & (take.orientation != truth.orientation)),
        depth=sum(inputs(true_lean[:, i], wrong[:, i]) for i in range(len(LIMBS))),
        joints=sum(stretches(misplaced[:, i]) for i in range(len(LIMBS))),
    )


def measured(performer: int) -> dict[str, Any]:
    """The dance's effort by hand, the thesis's way, and ours."""
    rig, someone = default_rig(320, 240), person(performer)
    motion = dance(someone, 0)
    truth = truth_of(motion, rig)
    with tempfile.TemporaryDirectory(prefix="tritrack-dance-") as name:
        folder = Path(name)
        write_clip(folder / "dance", someone, motion, Filming(rig, performer, performer), 0)
        video = folder / "dance" / "cam1.avi"
        facts = single_all([video], folder, Given(), Settings(size="320x240"), Console(quiet=True))
        with np.load(folder / "cam1" / "poses.npz") as poses:
            take = take_of(dict(poses))
    tall_px = float(np.median(np.ptp(truth.joints_px[..., 1], axis=1)))
    rows = take.frame
    seen = truth._replace(**{key: value[rows] for key, value in truth._asdict().items()})
    lacking = mending_inputs(take, seen, NEAR * tall_px)
    return {
        **facts["clips"]["cam1"]["effort"],
        "frames_with_pose": int(take.posed.sum()),
        "inputs_that_would_put_it_right": msgspec.to_builtins(lacking) | {"all": lacking.total},
        "thesis": msgspec.to_builtins(PRINTED[1].inputs) | {"by_hand": PRINTED[1].by_hand},
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--performer", type=int, default=900, help="seed of the dancer")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    found = measured(given.performer)
    if given.json:
        print(json.dumps(found))
        return
    for name, value in found.items():
        print(f"{name}: {value}")


if __name__ == "__main__":
    main()
