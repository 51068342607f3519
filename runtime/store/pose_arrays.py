"""The arrays of a run's poses: in memory, or mapped from files where they are many."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, NamedTuple

import numpy as np

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES, LIMBS
from common.body.extremities import EXTREMITY_NAMES
from common.bus.messages import Body, Lifting
from common.npz_file import Arrays

AT_ONCE: Final = 2_000
"""Rows in memory: some 10 kB each until they are arrays."""

Laid = Callable[[Arrays], Arrays]


def poses(bodies: Iterable[Body], cameras: Sequence[str] = ()) -> Arrays:
    """The arrays of a run; a row without a pose is NaN.

    It iterates twice over the bodies, some thousand at once. Arrays of joints and extremities are
    separate here; `on_disk` concatenates them for `poses.npz`.

    Args:
        bodies: Of the run.
        cameras: Names of the rig's cameras; default cam1, cam2 ...
    """
    told, coming = _told_by(bodies, cameras), iter(bodies)
    found = [_arrays(list(islice(coming, AT_ONCE)), told)]
    while len(found[-1]["frame"]) == AT_ONCE:
        found.append(_arrays(list(islice(coming, AT_ONCE)), told))
    return {
        name: array if name.endswith("_names") else np.concatenate([each[name] for each in found])
        for name, array in found[0].items()
    }


@contextmanager
def mapped_poses(
    bodies: Iterable[Body],
    folder: Path,
    laid: Laid = lambda arrays: arrays,
    cameras: Sequence[str] = (),
) -> Iterator[Arrays]:
    """The same for any number of bodies; for many the arrays are mapped from temporary files.

    Args:
        bodies: Iterated twice.
        folder: For the files.
        laid: Combines arrays, `on_disk`.
        cameras: As for `poses`.
    """
    told, coming = _told_by(bodies, cameras), iter(bodies)
    arrays = laid(_arrays(list(islice(coming, AT_ONCE)), told))
    if len(arrays["frame"]) < AT_ONCE:
        yield arrays
        return
    with TemporaryDirectory(prefix=".poses.", dir=folder) as held:
        files = {name: Path(held, name) for name in arrays if not name.endswith("_names")}
        rows = 0
        while len(arrays["frame"]):
            rows += len(arrays["frame"])
            for name, path in files.items():
                with path.open("ab") as file:
                    file.write(arrays[name].tobytes())
            arrays = laid(_arrays(list(islice(coming, AT_ONCE)), told))
        mapped = {
            name: np.memmap(path, arrays[name].dtype, "r", shape=(rows, *arrays[name].shape[1:]))
            for name, path in files.items()
        }
        yield {name: mapped.get(name, array) for name, array in arrays.items()}


class _Told(NamedTuple):
    """The arrays other than joints."""

    extremities: bool
    """Whether all bodies with joints have extremities."""
    liftings: bool
    """Whether any body has a lifting."""
    cameras: tuple[str, ...]
    """Names of the rig's cameras."""


def _told_by(bodies: Iterable[Body], names: Sequence[str]) -> _Told:
    without = lifted = False
    count = max(2, len(names))
    for body in bodies:
        without = without or bool(body.joints_m and not body.extremities_m)
        lifted = lifted or body.lifting is not None
        count = max(count, len(body.score), len(body.joints_px))
    cameras = (*names, *(f"cam{n + 1}" for n in range(len(names), count)))
    return _Told(not without, lifted, cameras)


def _arrays(bodies: Sequence[Body], told: _Told) -> Arrays:
    n, cameras = len(bodies), len(told.cameras)

    def rows(values: Iterable[Any], shape: tuple[int, ...]) -> Any:
        empty = np.full(shape, np.nan)
        table = [np.reshape(value, shape) if len(value) else empty for value in values]
        return np.array(table, np.float64).reshape(n, *shape)

    in_pose = list(ANGLES_IN_POSE)
    return {
        "frame": np.array([body.frame for body in bodies], np.int64),
        "person": np.array([body.person for body in bodies], np.int64),
        "time_s": np.array([body.captured_s for body in bodies], np.float64),
        "joints_m": rows((body.joints_m for body in bodies), (len(JOINT_NAMES), 3)),
        "joint_names": np.array(JOINT_NAMES),
        **(_extremities(bodies, rows, cameras) if told.extremities else {}),
        "joints_px": rows((body.joints_px for body in bodies), (cameras, len(JOINT_NAMES), 2)),
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
        "camera_names": np.array(told.cameras),
        **_by_camera(bodies, cameras),
        **(_liftings([body.lifting for body in bodies]) if told.liftings else {}),
    }


def _by_camera(bodies: Sequence[Body], cameras: int) -> Arrays:
    """The arrays by camera; for two cameras also the word for both."""
    n = len(bodies)
    words = {"views": np.array([body.views for body in bodies], "U4")} if cameras == 2 else {}
    return {
        **words,
        "seen": np.array([body.seen for body in bodies], np.bool_).reshape(n, cameras),
        "score": np.array([body.score for body in bodies], np.float64).reshape(n, cameras),
        "facing": np.array([body.facing for body in bodies], "U6").reshape(n, cameras),
    }


def _extremities(bodies: Sequence[Body], rows: Callable[..., Any], cameras: int) -> Arrays:
    """Nose, heels, toes and knuckles."""
    count = len(EXTREMITY_NAMES)
    sure = (body.extremities_confidence or (0.0,) * count for body in bodies)
    return {
        "extremities_m": rows((body.extremities_m for body in bodies), (count, 3)),
        "extremities_px": rows((body.extremities_px for body in bodies), (cameras, count, 2)),
        "extremities_confidence": np.array(list(sure), np.float64).reshape(-1, count),
    }


def _liftings(told: Sequence[Lifting | None]) -> Arrays:
    """Decisions of a single view, where there are any: the arrays that retouching needs."""
    nothing = Lifting("", 1.0, ())
    each = [one or nothing for one in told]

    def limbs(values: Iterable[tuple[float, ...]], otherwise: float) -> Any:
        missing = (otherwise,) * len(LIMBS)
        return np.array([value or missing for value in values], np.float64).reshape(-1, len(LIMBS))

    return {
        "orientation": np.array([one.orientation for one in each], "U14"),
        "orientation_confidence": np.array([one.orientation_confidence for one in each]),
        "depth_confidence": limbs((one.depth_confidence for one in each), 1.0),
        "depth_error_deg": limbs((one.depth_error_deg for one in each), np.nan),
    }
