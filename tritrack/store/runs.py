"""Run folders: the poses, the summary and the postures of a run, as files."""

import platform
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np

from common.atomic_file import replacing
from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES, LIMBS
from common.body.extremities import EXTREMITY_NAMES
from common.bus.messages import Body, Lifting, Posture
from common.config import Settings
from tritrack.store.joint_arrays import on_disk
from tritrack.terminal import json_text

VERSIONS_OF: Final = ("tritrack", "numpy", "opencv-python-headless", "numba", "eclipse-zenoh")

BELIEVED: Final = ("measuring", "tracking", "predicted")
"""Of a body's status: what the views show bears it out, or did a moment ago."""


class RunError(RuntimeError):
    """A run folder that cannot be written; the text names it and the cure."""


def write_run(
    folder: Path,
    bodies: Sequence[Body],
    settings: Settings,
    facts: dict[str, Any],
) -> None:
    """Write `poses.npz` and `summary.json`, each whole or not at all.

    Args:
        folder: Made where it is not there.
        bodies: In the order of time; an instant that camera 1 missed (frame -1) gets no row.
        settings: As resolved for the run.
        facts: What else the summary tells: seconds, scale_source, warnings ...

    Raises:
        RunError: When the folder or a file cannot be written: no space, no right.
    """
    bodies = rows_of(bodies)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(folder / "poses.npz") as path, path.open("wb") as file:
            np.savez(file, allow_pickle=False, **on_disk(poses(bodies)))
        _write_json(folder / "summary.json", summary_of(bodies, settings, facts))
    except OSError as error:
        raise _unwritable(folder, error) from error


def rows_of(bodies: Sequence[Body]) -> list[Body]:
    """Those that get a row: of the instants that have a frame's number."""
    return [body for body in bodies if body.frame >= 0]


def write_postures(folder: Path, postures: Iterable[Posture], performed: str) -> None:
    """Write `posture.json`: performances, each frame's name and scores, the clip's name."""
    postures = list(postures)
    events = [msgspec.to_builtins(posture.event) for posture in postures if posture.event]
    rows = [
        {
            "frame": posture.frame,
            "time_s": round(posture.captured_s, 4),
            "name": posture.name,
            "segment": posture.segment,
            "doing": posture.doing,
            "log_likelihoods": {
                name: round(value, 3) for name, value in posture.log_likelihoods.items()
            },
        }
        for posture in postures
        if posture.frame >= 0
    ]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write_json(
            folder / "posture.json", {"posture": performed, "events": events, "frames": rows}
        )
    except OSError as error:
        raise _unwritable(folder, error) from error


def poses(bodies: Sequence[Body]) -> dict[str, Any]:
    """The arrays of a run; a row without a pose is NaN.

    What `poses.npz` holds of each joint, `on_disk` lays together: the 15, then the extremities.
    """
    n = len(bodies)

    def rows(values: Iterable[Any], shape: tuple[int, ...]) -> Any:
        empty = np.full(shape, np.nan)
        table = [np.reshape(value, shape) if len(value) else empty for value in values]
        return np.array(table, np.float64).reshape(n, *shape)

    in_pose = list(ANGLES_IN_POSE)
    return {
        "frame": np.array([body.frame for body in bodies], np.int64),
        "time_s": np.array([body.captured_s for body in bodies], np.float64),
        "joints_m": rows((body.joints_m for body in bodies), (len(JOINT_NAMES), 3)),
        "joint_names": np.array(JOINT_NAMES),
        **_extremities(bodies, rows),
        "joints_px": rows((body.joints_px for body in bodies), (2, len(JOINT_NAMES), 2)),
        "angles_deg": rows(
            ([body.pose[i] for i in in_pose] if body.pose else () for body in bodies),
            (len(ANGLE_NAMES),),
        ),
        "angle_names": np.array(ANGLE_NAMES),
        "angles_raw_deg": rows((body.angles_raw_deg for body in bodies), (len(ANGLE_NAMES),)),
        "confidence": np.array(
            [body.confidence or (0.0,) * len(JOINT_NAMES) for body in bodies], np.float64
        ).reshape(n, len(JOINT_NAMES)),
        "status": np.array([body.status for body in bodies], "U9"),
        "views": np.array([body.views for body in bodies], "U4"),
        "score": np.array([body.score for body in bodies], np.float64).reshape(n, 2),
        "facing": np.array([body.facing for body in bodies], "U6").reshape(n, 2),
        **_liftings([body.lifting for body in bodies]),
    }


def _extremities(bodies: Sequence[Body], rows: Callable[..., Any]) -> dict[str, Any]:
    """Nose, heels, toes and knuckles, if all bodies that have joints tell of them."""
    if any(body.joints_m and not body.extremities_m for body in bodies):
        return {}
    count = len(EXTREMITY_NAMES)
    sure = (body.extremities_confidence or (0.0,) * count for body in bodies)
    return {
        "extremities_m": rows((body.extremities_m for body in bodies), (count, 3)),
        "extremities_px": rows((body.extremities_px for body in bodies), (2, count, 2)),
        "extremities_confidence": np.array(list(sure), np.float64).reshape(-1, count),
    }


def _liftings(told: Sequence[Lifting | None]) -> dict[str, Any]:
    """What one view alone decided by itself, where it did: the arrays that retouching needs."""
    if not any(told):
        return {}
    nothing = Lifting("", 1.0, ())
    each = [one or nothing for one in told]

    def limbs(values: Iterable[tuple[float, ...]], otherwise: float) -> Any:
        missing = (otherwise,) * len(LIMBS)
        return np.array([value or missing for value in values], np.float64)

    return {
        "orientation": np.array([one.orientation for one in each], "U14"),
        "orientation_confidence": np.array([one.orientation_confidence for one in each]),
        "depth_confidence": limbs((one.depth_confidence for one in each), 1.0),
        "depth_error_deg": limbs((one.depth_error_deg for one in each), np.nan),
    }


def believed(bodies: Sequence[Body]) -> float | None:
    """Share of the frames with a person in which the body is believed; None where nobody is."""
    seen = [body.status for body in bodies if body.status != "empty"]
    if not seen:
        return None
    return round(sum(status in BELIEVED for status in seen) / len(seen), 4)


def summary_of(bodies: Sequence[Body], settings: Settings, facts: dict[str, Any]) -> dict[str, Any]:
    """What `summary.json` tells of these bodies, with the facts given."""
    with_pose = [body for body in bodies if body.joints_m]
    return {
        "frames": len(bodies),
        "frames_with_pose": len(with_pose),
        "status": {
            status: sum(body.status == status for body in bodies)
            for status in ("empty", "measuring", "tracking", "predicted", "lost")
        },
        "believed": believed(bodies),
        "matches_a_frame": round(float(np.mean([b.matches for b in with_pose])), 1)
        if with_pose
        else 0.0,
        **facts,
        "bdp_m": msgspec.to_builtins(bodies[-1].bdp) if bodies else None,
        "versions": versions(),
        "settings": msgspec.to_builtins(settings),
    }


@cache
def versions() -> dict[str, str]:
    """Of what a run depends on; looking them up takes as long as ten frames."""
    told = {name: version(name) for name in VERSIONS_OF}
    return told | {"python": platform.python_version()}


def _unwritable(folder: Path, error: OSError) -> RunError:
    reason = error.strerror or str(error)
    return RunError(f"cannot write {folder}: {reason}; free some space or name another --out")


def _write_json(path: Path, value: Any) -> None:
    with replacing(path) as new:
        new.write_text(json_text(value) + "\n")
