"""A run of the past: its poses and its summary, checked while they are read."""

import json
import re
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMBS
from common.body.extremities import EXTREMITY_NAMES
from common.npz_file import Arrays, Facts, read_arrays
from runtime.store.joint_arrays import parted

if TYPE_CHECKING:
    from runtime.store.past_journal import Told

MAX_BYTES: Final = 1 << 31
"""Upper bound of a run's poses, bytes: twenty hours at 15 Hz."""

ROWS: Final[dict[str, tuple[str, tuple[int, ...]]]] = {
    "frame": ("iu", ()),
    "person": ("iu", ()),
    "time_s": ("f", ()),
    "joints_m": ("f", (len(JOINT_NAMES), 3)),
    "angles_deg": ("f", (len(ANGLE_NAMES),)),
    "confidence": ("f", (len(JOINT_NAMES),)),
    "status": ("U", ()),
}
"""The arrays read from `poses.npz`: type of entries and shape of a row."""
CAMERA_ROWS: Final[dict[str, tuple[str, tuple[int, ...]]]] = {
    "joints_px": ("f", (len(JOINT_NAMES), 2)),
    "seen": ("b", ()),
    "score": ("f", ()),
}
"""The same for arrays by camera: a row has one such entry per camera."""
SINGLE_ROWS: Final[dict[str, tuple[str, tuple[int, ...]]]] = {
    "orientation": ("U", ()),
    "orientation_confidence": ("f", ()),
    "depth_confidence": ("f", (len(LIMBS),)),
}
"""Additional arrays of a run with a single view."""
EXTREMITY_ROWS: Final[dict[str, tuple[str, tuple[int, ...]]]] = {
    "extremities_m": ("f", (len(EXTREMITY_NAMES), 3)),
    "extremities_confidence": ("f", (len(EXTREMITY_NAMES),)),
}
"""Arrays of the extremities; older runs lack them."""
EXTREMITY_CAMERA_ROWS: Final[dict[str, tuple[str, tuple[int, ...]]]] = {
    "extremities_px": ("f", (len(EXTREMITY_NAMES), 2)),
}
"""The same by camera."""
CUT_SHORT: Final = "the run was cut short, or goes on: what it measured is read from its journal"


class PastRunError(ValueError):
    """A run folder that cannot be read: the text names it and the cure."""


class PastRun(NamedTuple):
    """The results of a run."""

    folder: Path
    poses: Arrays
    """Arrays by name: those of ROWS and CAMERA_ROWS, of the extremities where it has them, and
    others in the file. `camera_names` are the C cameras of the entries by camera."""
    summary: Facts


def is_run(folder: Path) -> bool:
    """Whether a folder holds a run, complete or cut short."""
    from runtime.store.journal import has_journal

    return (folder / "poses.npz").is_file() or has_journal(folder)


def open_run(folder: Path) -> PastRun:
    """Read a run folder; for a run that was cut short, its journal.

    Raises:
        PastRunError: When it is no run folder, is damaged, or is of a newer version.
    """
    if not folder.is_dir():
        raise PastRunError(f"there is no run folder {folder}: name one that `tritrack track` wrote")
    from runtime.store.past_journal import read_journal

    told = read_journal(folder)
    if told is not None:
        return _cut_short(folder, told)
    path = folder / "poses.npz"
    if not path.exists():
        raise PastRunError(f"{folder} has no poses.npz: {_how_to_track(folder)}")
    try:
        summary = json.loads((folder / "summary.json").read_text())
        _refuse_a_newer_version(folder, summary)
        poses = _completed(parted(read_arrays(path, MAX_BYTES)))
    except PastRunError:
        raise
    except FileNotFoundError as error:
        raise PastRunError(f"{folder} has no summary.json: track the clip again") from error
    except OSError as error:
        raise PastRunError(
            f"cannot read {error.filename or folder}: {error.strerror}; see that you may read it"
        ) from error
    except ValueError as error:
        raise PastRunError(f"{folder} was damaged ({error}): track the clip again") from error
    _refuse_other_arrays(path, poses)
    return PastRun(folder, poses, summary if isinstance(summary, dict) else {})


def _refuse_a_newer_version(folder: Path, summary: object) -> None:
    """A later minor version may change meanings; a patch does not."""
    told = summary.get("versions") if isinstance(summary, dict) else None
    theirs = str(told.get("tritrack")) if isinstance(told, dict) else ""
    ours = version("tritrack")
    if _minor(theirs) > _minor(ours):
        raise PastRunError(
            f"{folder} was written by tritrack {theirs}, and this is {ours}: "
            "read it with that version (pip install --upgrade tritrack)"
        )


def _minor(told: str) -> tuple[int, ...]:
    """The first two numbers of a version; an invalid one sorts before all others."""
    found = re.match(r"(\d+)\.(\d+)", told)
    return tuple(map(int, found.groups())) if found else ()


def _how_to_track(folder: Path) -> str:
    from runtime.store.journal import has_journal

    if any(folder.glob("cam[1-8].*")):
        return f"it is a clip; track it first: tritrack track {folder}"
    if has_journal(folder):
        return (
            "it was cut short, and its journal is empty or of another version of tritrack: "
            "track the clip again, or read it with the version that wrote it"
        )
    return "name one that `tritrack track` wrote"


def _cut_short(folder: Path, told: "Told") -> PastRun:
    from runtime.store.pose_arrays import poses
    from runtime.store.runs import Rows, summary_of

    bodies = Rows(told.bodies)
    named = [posture.name for posture in told.postures if posture.name]
    facts = {
        **told.head.facts,
        "scale_source": told.cameras[-1].scale_source if told.cameras else None,
        "posture": named[-1] if named else "",
        "warnings": [CUT_SHORT],
    }
    return PastRun(folder, poses(bodies), summary_of(bodies, told.head.settings, facts))


def _completed(poses: Arrays) -> Arrays:
    """The arrays with those that 0.2 lacked: one person, two cameras, and who is seen."""
    if "camera_names" in poses or "views" not in poses:
        return poses
    from runtime.store.older_messages import seen_by

    words = np.ravel(poses["views"])
    seen = np.array([seen_by(str(word)) for word in words], np.bool_).reshape(-1, 2)
    person = np.zeros(len(words), np.int64)
    return {**poses, "person": person, "camera_names": np.array(("cam1", "cam2")), "seen": seen}


def _refuse_other_arrays(path: Path, poses: Arrays) -> None:
    rows = len(poses["frame"]) if np.ndim(poses.get("frame", 0)) == 1 else 0
    cameras = len(np.ravel(poses.get("camera_names", ())))
    if not cameras:
        raise PastRunError(f"{path}: camera_names are missing: track it again")
    further = SINGLE_ROWS | EXTREMITY_ROWS | _by_camera(EXTREMITY_CAMERA_ROWS, cameras)
    due = ROWS | _by_camera(CAMERA_ROWS, cameras)
    known = due | {name: row for name, row in further.items() if name in poses}
    for name, (kinds, shape) in known.items():
        array = np.asarray(poses.get(name))
        if array.shape != (rows, *shape) or array.dtype.kind not in kinds:
            found = f"{array.dtype} {array.shape}" if name in poses else "missing"
            raise PastRunError(f"{path}: {name} is {found}, not {(rows, *shape)}: track it again")
    if tuple(str(name) for name in np.ravel(poses.get("joint_names", ()))) != JOINT_NAMES:
        raise PastRunError(f"{path}: joint_names are not those of this version: track it again")


def _by_camera(
    rows: dict[str, tuple[str, tuple[int, ...]]], cameras: int
) -> dict[str, tuple[str, tuple[int, ...]]]:
    return {name: (kinds, (cameras, *shape)) for name, (kinds, shape) in rows.items()}
