"""A run's rows in each format of other programs."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.npz_file import Facts
from runtime.store.joint_arrays import all_joints_m
from runtime.store.past_run import PastRun
from runtime.store.run_exports import Format

if TYPE_CHECKING:
    from animator.skeleton.bones import Motion, Skeleton

Scale = Literal["m", "cm"]


class ExportError(RuntimeError):
    """A run that cannot be exported: the text names the cause and the cure."""


class Written(NamedTuple):
    """The result of an export."""

    content: bytes
    facts: Facts
    """The command's output; it contains `frames`."""
    beside: tuple[str, bytes] | None = None
    """Suffix and content of a second file."""


class _Animated(NamedTuple):
    """A run as a moving skeleton."""

    skeleton: "Skeleton"
    motion: "Motion"
    step_s: float
    facts: Facts


def _animated(run: PastRun) -> _Animated:
    from animator.bvh import steady
    from animator.even_steps import with_gaps
    from animator.skeleton.bones import joints_of

    joints_m = run.poses["joints_m"]
    skeleton, motion, steps = steady(all_joints_m(run.poses), run.poses["time_s"])
    off_m = joints_of(skeleton, motion)[:, : len(JOINT_NAMES)] - with_gaps(joints_m, steps)
    off_mm = 1e3 * np.linalg.norm(off_m[steps.seen], axis=2)
    facts = {
        "frames": steps.frames,
        "first_frame": int(run.poses["frame"][steps.posed[0]]),
        "filled": int((~steps.seen).sum()),
        "off_mm": {
            "median": round(float(np.median(off_mm)), 2),
            "p95": round(float(np.percentile(off_mm, 95)), 2),
        },
    }
    return _Animated(skeleton, motion, steps.step_s, facts)


def _bvh(run: PastRun, _name: str, scale: Scale) -> Written:
    from animator.bvh import bvh_text

    made = _animated(run)
    text = bvh_text(made.skeleton, made.motion, made.step_s, scale)
    return Written(text.encode(), {**made.facts, "unit": scale})


def _gltf(run: PastRun, _name: str, _scale: Scale) -> Written:
    from animator.exchange.gltf import gltf_bytes

    made = _animated(run)
    return Written(gltf_bytes(made.skeleton, made.motion, made.step_s), made.facts)


def _fbx(run: PastRun, _name: str, _scale: Scale) -> Written:
    from animator.exchange.fbx import fbx_bytes

    made = _animated(run)
    return Written(fbx_bytes(made.skeleton, made.motion, made.step_s), made.facts)


def _usd(run: PastRun, name: str, _scale: Scale) -> Written:
    from animator.exchange.usd import usd_bytes

    made = _animated(run)
    content = usd_bytes(made.skeleton, made.motion, made.step_s, Path(name).suffix.lower())
    return Written(content, made.facts)


def _mot(run: PastRun, name: str, _scale: Scale) -> Written:
    from animator.exchange.opensim_model import mot_text, osim_text

    made = _animated(run)
    text = mot_text(made.motion, made.step_s, name)
    return Written(text.encode(), made.facts, (".osim", osim_text(made.skeleton).encode()))


def _trc(run: PastRun, name: str, _scale: Scale) -> Written:
    from animator.exchange.marker_files import trc_text

    joints_m, step_s, facts = _markers(run)
    return Written(trc_text(joints_m, step_s, name).encode(), facts)


def _c3d(run: PastRun, _name: str, _scale: Scale) -> Written:
    from animator.exchange.marker_files import MOST_C3D_FRAMES, c3d_bytes

    joints_m, step_s, facts = _markers(run)
    if len(joints_m) > MOST_C3D_FRAMES:
        raise ExportError(
            f"{run.folder} would be {len(joints_m)} frames, and c3d has room for {MOST_C3D_FRAMES}:"
            " export it to trc, which has for all"
        )
    return Written(c3d_bytes(joints_m, step_s), facts)


def _markers(run: PastRun) -> tuple[NDArray[np.float64], float, Facts]:
    """The run's joints in even steps with its gaps, seconds per frame, and facts for the output."""
    from animator.even_steps import even_steps, with_gaps
    from animator.skeleton.planted_feet import planted

    joints_m, time_s = all_joints_m(run.poses), run.poses["time_s"]
    steps = even_steps(joints_m, time_s)
    facts = {
        "frames": steps.frames,
        "first_frame": int(run.poses["frame"][steps.posed[0]]),
        "empty": int((~steps.seen).sum()),
    }
    return with_gaps(planted(joints_m, time_s).joints_m, steps), steps.step_s, facts


def _csv(run: PastRun, _name: str, _scale: Scale) -> Written:
    from animator.exchange.spreadsheet import csv_text

    return Written(csv_text(run.poses).encode(), {"frames": len(run.poses["frame"])})


def _angles(run: PastRun, _name: str, _scale: Scale) -> Written:
    from animator.clinical.clinical_run import angles_csv

    return Written(angles_csv(run.poses).encode(), {"frames": len(run.poses["frame"])})


WRITERS: Final[dict[Format, Callable[[PastRun, str, Scale], Written]]] = {
    "bvh": _bvh,
    "gltf": _gltf,
    "fbx": _fbx,
    "usd": _usd,
    "trc": _trc,
    "mot": _mot,
    "c3d": _c3d,
    "csv": _csv,
    "angles": _angles,
}
"""By format, the file of a run under a name; NoMotion where it has too few poses."""
