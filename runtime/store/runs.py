"""Run folders: the poses, the summary and the postures of a run, as files."""

import platform
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path
from textwrap import indent
from typing import Any, Final, get_args

import msgspec
import numpy as np

from common.atomic_file import replacing, unwritten
from common.bus.messages import Body, Posture, Status
from common.config.config_file import with_absolute_paths
from common.config.settings import Settings
from common.npz_file import Facts
from runtime.store.joint_arrays import on_disk
from runtime.store.pose_arrays import mapped_poses
from runtime.store.run_exports import remove_exports
from runtime.terminal import json_text

VERSIONS_OF: Final = ("tritrack", "numpy", "opencv-python-headless", "numba", "eclipse-zenoh")

BELIEVED: Final[tuple[Status, ...]] = ("measuring", "tracking")
"""Statuses of a believed body: the views confirm it. A predicted body was confirmed a moment
ago: it has a pose, with confidence 0."""
CONFIDENT: Final = 0.5
"""Mean confidence of a body's joints below which its frame counts less as believed: the joints
are then more likely wrong than right."""

NO_PERSON_SEEN: Final = (
    "nobody was seen: the person must move, and be a sixth of the picture high at least"
)
"""The warning for a run without a person in any frame."""


class RunError(RuntimeError):
    """A run folder that cannot be written; the text names it and the cure."""


def write_run(
    folder: Path,
    bodies: Iterable[Body],
    settings: Settings,
    facts: Facts,
) -> None:
    """Write `poses.npz` and `summary.json`, each completely or not at all.

    Exports of a previous run are removed: they are of other poses.

    Args:
        folder: Created where missing.
        bodies: In the order of time; an instant that camera 1 missed (frame -1) gets no row.
        settings: The resolved settings of the run; its summary has their paths as absolute ones.
        facts: Further facts for the summary: cameras (their names), seconds, scale_source, warnings
            ...

    Raises:
        RunError: When the folder or a file cannot be written: no space, no permission.
    """
    rows, own = Rows(bodies), with_absolute_paths(settings)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (
            mapped_poses(rows, folder, on_disk, facts.get("cameras", ())) as arrays,
            replacing(folder / "poses.npz") as path,
            path.open("wb") as file,
        ):
            np.savez(file, allow_pickle=False, **arrays)
        _write_json(folder / "summary.json", summary_of(rows, own, facts))
        remove_exports(folder)
    except OSError as error:
        raise unwritable(folder, error) from error


class Rows:
    """The bodies that get a row: of instants with a frame number."""

    def __init__(self, bodies: Iterable[Body]) -> None:
        """From these, which may be iterated more than once."""
        self._bodies = bodies

    def __iter__(self) -> Iterator[Body]:
        """In order."""
        return (body for body in self._bodies if body.frame >= 0)


def write_postures(folder: Path, postures: Iterable[Posture], performed: str) -> None:
    """Write `posture.json`: performances, each frame's name and scores, the clip's name.

    Args:
        folder: Created where missing.
        postures: In the order of time; iterated twice, and need not fit into memory.
        performed: The clip's posture.

    Raises:
        RunError: When it cannot be written.
    """
    ended = (posture for posture in postures if posture.event)
    newest = {(one.person, one.event.name, one.event.onset_s): one for one in ended if one.event}
    events = [
        {**_whose(posture), **msgspec.to_builtins(posture.event)} for posture in newest.values()
    ]
    told = json_text({"posture": performed, "events": events, "frames": []})
    begin, _, end = told.rpartition("]")
    rows = (_row_of(posture) for posture in postures if posture.frame >= 0)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(folder / "posture.json") as new, new.open("w") as file:
            file.write(begin)
            between = ""
            for row in rows:
                file.write(f"{between}\n{indent(json_text(row), '  ')}")
                between = ","
            file.write(f"{chr(10) + ' ' if between else ''}]{end}\n")
    except OSError as error:
        raise unwritable(folder, error) from error


def _whose(posture: Posture) -> Facts:
    """The number of a person among several."""
    return {"person": posture.person} if posture.person else {}


def _row_of(posture: Posture) -> Facts:
    return {
        **_whose(posture),
        "frame": posture.frame,
        "time_s": round(posture.captured_s, 4),
        "name": posture.name,
        "segment": posture.segment,
        "doing": posture.doing,
        "log_likelihoods": {
            name: round(value, 3) for name, value in posture.log_likelihoods.items()
        },
    }


def belief_facts(bodies: Iterable[Body]) -> Facts:
    """`followed`: share of the frames with a person in which the views confirm the body; in
    `believed` such a frame counts less where the joints' mean confidence is below CONFIDENT. Both
    are None without a person."""
    often: Counter[Status] = Counter()
    belief = 0.0
    for body in bodies:
        often[body.status] += 1
        belief += _belief(body)
    return _belief_facts(often, belief)


def _belief_facts(often: Counter[Status], belief: float) -> Facts:
    seen = often.total() - often["empty"]
    confirmed = sum(often[status] for status in BELIEVED)
    return {"believed": _share(belief, seen), "followed": _share(confirmed, seen)}


def _belief(body: Body) -> float:
    """How much a frame counts as believed, in [0, 1]."""
    if body.status not in BELIEVED:
        return 0.0
    return min(1.0, sum(body.confidence) / max(len(body.confidence), 1) / CONFIDENT)


def _share(belief: float, seen: int) -> float | None:
    return round(belief / seen, 4) if seen else None


class _Person:
    """What is counted of one of several people."""

    def __init__(self) -> None:
        self.frames = self.believed = 0

    def add(self, body: Body) -> None:
        self.frames += 1
        self.believed += body.status in BELIEVED


class _Counts:
    """What is counted of a run's bodies, one after the other."""

    def __init__(self) -> None:
        self.often: Counter[Status] = Counter()
        self.belief = 0.0
        self.matches: list[int] = []
        self.people: dict[int, _Person] = {}
        self.instants = self.believed_instants = 0
        self.last: Body | None = None
        self._is_believed = False

    def add(self, body: Body) -> None:
        """Count a body; those of an instant come in a row."""
        self.often[body.status] += 1
        self.belief += _belief(body)
        if body.joints_m:
            self.matches.append(body.matches)
        if body.person:
            self.people.setdefault(body.person, _Person()).add(body)
        if self.last is None or body.captured_s != self.last.captured_s:
            self.instants += 1
            self._is_believed = False
        if body.status in BELIEVED and not self._is_believed:
            self._is_believed = True
            self.believed_instants += 1
        self.last = body

    @property
    def of_people(self) -> Facts:
        """By number of each of several people."""
        if not self.people:
            return {}
        each = {str(number): vars(one) for number, one in sorted(self.people.items())}
        return {"people": each}


def summary_of(bodies: Iterable[Body], settings: Settings, facts: Facts) -> Facts:
    """The summary of these bodies, with the given facts."""
    counts = _Counts()
    for body in bodies:
        counts.add(body)
    matches, last = counts.matches, counts.last
    return {
        "frames": counts.often.total(),
        "frames_with_pose": len(matches),
        "instants": counts.instants,
        "instants_believed": counts.believed_instants,
        "status": {status: counts.often[status] for status in get_args(Status)},
        **counts.of_people,
        **_belief_facts(counts.often, counts.belief),
        "matches_a_frame": round(float(np.mean(matches)), 1) if matches else 0.0,
        **facts,
        "bdp_m": None if last is None else msgspec.to_builtins(last.bdp),
        "versions": versions(),
        "settings": msgspec.to_builtins(settings),
    }


@cache
def versions() -> dict[str, str]:
    """Versions that a run depends on; looking them up takes as long as ten frames."""
    told = {name: version(name) for name in VERSIONS_OF}
    return told | {"python": platform.python_version()}


def unwritable(folder: Path, error: OSError) -> RunError:
    """The message for a run folder that cannot be written."""
    return RunError(unwritten(folder, error, "name another --out"))


def _write_json(path: Path, value: Any) -> None:
    with replacing(path) as new:
        new.write_text(json_text(value) + "\n")
