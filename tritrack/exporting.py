"""A run as a file for other programs: animation, movement laboratories, spreadsheets."""

import csv
import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from animator.exchange import LibraryMissing
from common.atomic_file import refuse_to_replace, replacing, unwritten
from common.body.body import ANGLE_NAMES, JOINT_NAMES
from common.body.extremities import EXTREMITY_NAMES
from common.npz_file import Arrays, Facts
from runtime.store.joint_arrays import all_joints_m
from runtime.store.past_run import PastRun, open_run
from runtime.store.run_exports import OWN_NAMES, Format

if TYPE_CHECKING:
    from animator.skeleton.bones import Motion, Skeleton

Scale = Literal["m", "cm"]
ENDINGS: Final[dict[Format, tuple[str, ...]]] = {
    **{to: (Path(name).suffix,) for to, name in OWN_NAMES.items()},
    "usd": (".usdc", ".usd", ".usda"),
}
"""Allowed suffixes: none of them is a suffix of a run's own files or its video."""


class ExportError(RuntimeError):
    """A run that cannot be exported: the text names the cause and the cure."""


class Written(NamedTuple):
    """The result of an export."""

    content: bytes
    facts: Facts
    """The command's output; it contains `frames`."""
    beside: tuple[str, bytes] | None = None
    """Suffix and content of a second file."""


def export(
    folder: str | Path,
    to: Format,
    out: str | Path | None = None,
    *,
    scale: Scale = "m",
    replace: bool = False,
) -> Facts:
    """Write a run in another format, as `tritrack export` does.

    Examples:
        >>> from tritrack import export
        >>> written = export(folder, "csv")
        >>> written["frames"]
        69

    Args:
        folder: The run's folder.
        to: bvh, gltf, usd, trc, mot, c3d or csv.
        out: The file to write; None: the default one in the run folder, which is replaced.
        scale: Unit of a BVH file, m or cm; other formats define theirs.
        replace: True: a file at `out` may be replaced.

    Returns:
        `file`, `files`, `frames`, and for a skeleton of fixed bones `off_mm`, the distance of its
        joints from the run's.

    Raises:
        PastRunError: When there is no such run.
        ExportError: When it has no poses, the format's library is not installed, or the file cannot
            be written or has another format's suffix.
        FileRefused: When a file would be replaced.
    """
    if to not in OWN_NAMES:
        raise ExportError(f"there is no format {to!r}: there are {', '.join(OWN_NAMES)}")
    return export_run(Path(folder), to, None if out is None else Path(out), scale, replace)


def export_run(
    folder: Path, to: Format, out: Path | None, scale: Scale = "m", replace: bool = False
) -> Facts:
    """Write a run in another format.

    Args:
        folder: The run's folder.
        to: The format.
        out: The file to write; None: that of OWN_NAMES in the run folder, which is replaced.
        scale: Unit of a BVH file; other formats define theirs.
        replace: True: a file at `out` may be replaced.

    Returns:
        The file, its frames, and for a skeleton of fixed bones the distance of its joints from the
        run's.

    Raises:
        PastRunError: When there is no such run.
        ExportError: When it has no poses, the format's library is not installed, or the file cannot
            be written or has another format's suffix.
        FileRefused: When a file would be replaced.
    """
    if scale != "m" and to != "bvh":
        raise ExportError(f"--scale is for bvh: {to} has a unit of its own, leave it out")
    path = out or folder / OWN_NAMES[to]
    _refuse_ending(path, to)
    run = open_run(folder)
    try:
        written = _WRITERS[to](run, path.name, scale)
    except LibraryMissing as error:
        raise ExportError(str(error)) from error
    files = {path: written.content}
    if written.beside is not None:
        files[path.with_suffix(written.beside[0])] = written.beside[1]
    for place in files:
        refuse_to_replace(place, replace or out is None)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for place, content in files.items():
            with replacing(place) as new:
                new.write_bytes(content)
    except OSError as error:
        raise ExportError(unwritten(path, error, "name another --out")) from error
    return {"file": str(path), "files": [str(place) for place in files], **written.facts}


def _refuse_ending(path: Path, to: Format) -> None:
    """Refuse a name whose suffix belongs to another format."""
    if path.suffix.lower() not in ENDINGS[to]:
        raise ExportError(f"{path} is no name for {to}: let it end in {' or '.join(ENDINGS[to])}")


class _Animated(NamedTuple):
    """A run as a moving skeleton."""

    skeleton: "Skeleton"
    motion: "Motion"
    step_s: float
    facts: Facts


def _animated(run: PastRun) -> _Animated:
    from animator.bvh import steady
    from animator.even_steps import NoMotion, with_gaps
    from animator.skeleton.bones import joints_of

    joints_m = run.poses["joints_m"]
    try:
        skeleton, motion, steps = steady(all_joints_m(run.poses), run.poses["time_s"])
    except NoMotion as error:
        raise _motionless(run, error) from error
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
    from animator.even_steps import NoMotion, even_steps, with_gaps
    from animator.skeleton.planted_feet import planted

    joints_m, time_s = all_joints_m(run.poses), run.poses["time_s"]
    try:
        steps = even_steps(joints_m, time_s)
    except NoMotion as error:
        raise _motionless(run, error) from error
    facts = {
        "frames": steps.frames,
        "first_frame": int(run.poses["frame"][steps.posed[0]]),
        "empty": int((~steps.seen).sum()),
    }
    return with_gaps(planted(joints_m, time_s).joints_m, steps), steps.step_s, facts


def _motionless(run: PastRun, error: Exception) -> ExportError:
    return ExportError(f"{run.folder} cannot be animated: {error}; export another run")


def _csv(run: PastRun, _name: str, _scale: Scale) -> Written:
    text = io.StringIO()
    further = EXTREMITY_NAMES if "extremities_m" in run.poses else ()
    cameras = [str(name) for name in run.poses["camera_names"]]
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        [
            *("frame", "person", "time_s", "status"),
            *(f"seen_{camera}" for camera in cameras),
            *(f"score_{camera}" for camera in cameras),
            *(f"{joint}_{axis}_m" for joint in JOINT_NAMES for axis in "xyz"),
            *(f"{angle}_deg" for angle in ANGLE_NAMES),
            *(f"{joint}_confidence" for joint in JOINT_NAMES),
            *(f"{place}_{axis}_m" for place in further for axis in "xyz"),
            *(f"{place}_confidence" for place in further),
        ]
    )
    writer.writerows(_csv_rows(run.poses))
    return Written(text.getvalue().encode(), {"frames": len(run.poses["frame"])})


def _csv_rows(poses: Arrays) -> Iterator[list[int | str]]:
    names = ["score", "joints_m", "angles_deg", "confidence"]
    names += [name for name in ("extremities_m", "extremities_confidence") if name in poses]
    for i, frame in enumerate(poses["frame"]):
        numbers = [poses[name][i] for name in names]
        yield [
            int(frame),
            int(poses["person"][i]),
            *_cells(poses["time_s"][i], 4),
            str(poses["status"][i]),
            *(int(seen) for seen in poses["seen"][i]),
            *(cell for part in numbers for cell in _cells(part, 4)),
        ]


def _cells(values: ArrayLike, digits: int) -> list[str]:
    """Numbers for a spreadsheet; an unknown one is an empty cell."""
    return [f"{value:.{digits}f}" if np.isfinite(value) else "" for value in np.ravel(values)]


_WRITERS: Final[dict[Format, Callable[[PastRun, str, Scale], Written]]] = {
    "bvh": _bvh,
    "gltf": _gltf,
    "usd": _usd,
    "trc": _trc,
    "mot": _mot,
    "c3d": _c3d,
    "csv": _csv,
}
