"""Landmarks from files: one of OpenPose's JSON a frame, as other pose estimators write it too."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.observation import Landmarks
from common.config.part_settings import SettingsError
from common.rig.upright_camera import as_worked_on
from common.video.clip_facts import ClipView
from common.video.pictures import Decoded, Size
from viewer.landmarks.fifteen_joints import facing_deg, fifteen, fifteen_shares
from viewer.landmarks.keypoint_layouts import (
    BODY_POINTS,
    LAYOUTS,
    POINT,
    body_points,
    extremity_points,
)

MOST_FILES: Final = 200_000
MOST_BYTES: Final = 1 << 20
"""Of one file; OpenPose's with faces and hands have 10 kB a person."""
MOST_PEOPLE: Final = 100
FURTHEST_PX: Final = 1e5
"""Points may lie outside the picture, not elsewhere."""
NUMBERED: Final = re.compile(r"(\d+)(?:_keypoints)?\.json")

FACING: Final = [POINT[name] for name in ("nose", "l_ear", "l_shoulder", "r_shoulder")]
"""The points that show which way a person faces."""

Person = NDArray[np.float64]
"""(24, 3): columns and rows by our convention in the video's pixels, and scores: BODY_POINTS, then
EXTREMITY_NAMES."""


class _Person(msgspec.Struct):
    pose_keypoints_2d: list[float]


class _File(msgspec.Struct):
    people: list[_Person]


class KeypointFiles:
    """The files of one view, all read before the run; see `OutsideSource`."""

    large: Size | None = None

    def __init__(self, folder: Path, view: ClipView, alone: bool) -> None:
        """Read them.

        Args:
            folder: Of all views, or of the one view.
            view: Of a recorded clip.
            alone: The run has no other view: its files may stand in the folder itself.

        Raises:
            SettingsError: When there are none, or one of them is none; the text names it.
        """
        if isinstance(view.source, int):
            raise SettingsError(
                f"landmarks from files are for recorded clips: camera {view.number} is none"
            )
        own = _folder_of(folder, view, alone)
        self._scale = np.divide(view.filed_size, view.source_size)
        self._upright = view.upright
        self._frames = {frame: people_of(path) for frame, path in numbered(own).items()}
        last = max(self._frames) + 1
        short = view.frames and last < view.frames
        told = f"{own} ends after {last} of {view.frames} frames"
        self.odd: tuple[str, ...] = (told,) if short else ()

    def people(self, decoded: Decoded, wait_s: float) -> tuple[Landmarks, ...]:  # noqa: ARG002
        """All people in the file of a frame; none where there is no such file."""
        people = self._frames.get(decoded.index, ())
        return tuple(_landmarks_of(self._as_worked_on(person)) for person in people)

    def _as_worked_on(self, person: Person) -> Person:
        places = as_worked_on(self._scale * person[:, :2], self._upright)
        return np.concatenate([places, person[:, 2:]], axis=1)


def numbered(folder: Path) -> dict[int, Path]:
    """The files of a folder by the frames that they are of.

    Their names end in the frame's number, from 0 on; from 1 on where there is no 0.

    Raises:
        SettingsError: When there are none or too many, or a name has no frame number of its own.
    """
    found: dict[int, Path] = {}
    for path in sorted(folder.glob("*.json")):
        told = NUMBERED.search(path.name)
        if told is None:
            raise SettingsError(f"{path} names no frame: end it in its number, or take it away")
        frame = int(told[1])
        if frame in found:
            raise SettingsError(f"{path} and {found[frame].name} are of one frame: keep one")
        found[frame] = path
        if len(found) > MOST_FILES:
            raise SettingsError(f"{folder} has more than {MOST_FILES} files: cut the clip")
    if not found:
        raise SettingsError(f"{folder} has no keypoint files: they end in .json")
    first = 1 if min(found) == 1 else 0
    return {frame - first: path for frame, path in found.items()}


def people_of(path: Path) -> list[Person]:
    """All people of whom a file has at least one point.

    Raises:
        SettingsError: When it cannot be read or is no such file.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise SettingsError(f"{path} has more than {MOST_BYTES} bytes: it is no keypoint file")
        people = msgspec.json.decode(path.read_bytes(), type=_File).people
    except (OSError, msgspec.DecodeError, RecursionError) as error:
        raise SettingsError(
            f"{path} is no keypoint file ({error}): mend it or take it away"
        ) from error
    if len(people) > MOST_PEOPLE:
        raise SettingsError(f"{path} has {len(people)} people, at most {MOST_PEOPLE} are taken")
    seen = [_person(one.pose_keypoints_2d, path) for one in people]
    return [person for person in seen if person[:, 2].any()]


def _person(numbers: Sequence[float], path: Path) -> Person:
    points, rest = divmod(len(numbers), 3)
    if rest or points not in LAYOUTS:
        known = "BODY_25, COCO (17 or 18) and HALPE_26"
        raise SettingsError(f"{path}: a person of {len(numbers)} numbers; layouts are {known}")
    told = np.array(numbers, np.float64).reshape(points, 3)
    person = np.concatenate([body_points(told), extremity_points(told)])
    if not (np.abs(person) < FURTHEST_PX).all():
        raise SettingsError(f"{path}: a point lies nowhere near a picture: mend it")
    # They count from the middle of the first pixel, we from its corner.
    columns, rows, scores = person.T
    person = np.stack([columns + 0.5, rows + 0.5, np.clip(scores, 0.0, 1.0)], axis=1)
    return _with_a_whole_head(person)


def _with_a_whole_head(person: Person) -> Person:
    """Points of the head that are hidden have the score 0: they are put where they could be.

    In profile that is an ear: it is taken to be where the other is. From behind it is the nose: it
    is taken to be between the ears.
    """
    nose, left, right = (POINT[name] for name in ("nose", "l_ear", "r_ear"))
    for ear, other in ((left, right), (right, left)):
        if person[ear, 2] == 0:
            person[ear] = person[other]
    if person[nose, 2] == 0:
        person[nose] = (person[left] + person[right]) / 2
    return person


def _landmarks_of(person: Person) -> Landmarks:
    """Of a person in the working picture; the scores are taken for confidence as they are."""
    points, scores = person[: len(BODY_POINTS), :2], person[: len(BODY_POINTS), 2]
    joints, ends = fifteen(points), person[len(BODY_POINTS) :]
    return Landmarks(
        joints_px=tuple((float(u), float(v)) for u, v in joints),
        confidence=tuple(fifteen_shares(scores).tolist()),
        facing_deg=facing_deg(points),
        facing_confidence=float(scores[FACING].min()),
        extremities_px=tuple((float(u), float(v)) for u, v in ends[:, :2]),
        extremities_confidence=tuple(ends[:, 2].tolist()),
    )


def _folder_of(folder: Path, view: ClipView, alone: bool) -> Path:
    """Where the files of a view stand."""
    stem = Path(str(view.source)).stem
    names = [view.name, f"{stem}_json", *([""] if alone else [])]
    for place in (folder / name for name in names):
        if any(place.glob("*.json")):
            return place
    raise SettingsError(
        f"{folder} has no keypoint files of camera {view.number}: put them into "
        f"{folder / names[0]} or {folder / names[1]}"
    )
