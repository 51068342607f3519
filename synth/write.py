"""Clips of performances on disk: a video per camera, labels, and ground truth."""

import itertools
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final, Literal, NamedTuple

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from common.rig.camera import Camera, Rig, project
from synth.motion.crossing import crossing
from synth.motion.motions import POSTURES, Motion, movement, performance
from synth.motion.on_spot import on_spot
from synth.motion.streaming import streamed
from synth.person.people import MEASURE_NAMES, Person, measure_vector, person
from synth.person.skeleton import ANGLES, JOINTS
from synth.picture.actors import Part
from synth.picture.exposure import blurred, exposures
from synth.picture.random_rig import MOST_CAMERAS, rig_around
from synth.picture.render import Shot, render, render_scene

FPS: Final = 15.0
"""The paper's frame rate (P1)."""
JPEG_QUALITY: Final = 95
Packed = NDArray[np.uint8]
"""Masks packed by `np.packbits(mask, axis=-1)`."""

PHASES: Final = ("empty", "tpose", "transition", "motion")
ALONE: Final = ("free", "fall", "stream", "spot", "cross")
"""Motions that are one take each, not one per posture."""
PASSERS: Final = 1_000_000
"""What is added to a performer's number to give that of the person who crosses."""
ROOM_SEED: Final = 7919
"""Factor that separates the room seeds of successive sets: a prime larger than any set."""


class SynthError(ValueError):
    """A set of clips that cannot be made: the text names the cure."""


class ClipSet(NamedTuple):
    """Content of a set of clips."""

    motion: Literal["postures", "free", "fall", "stream", "spot", "cross"]
    """The named postures; free motion; free motion with falls; all postures in one take; on one
    spot from the first frame; the same while a second person walks past."""
    performers: int = 1
    """Number of people; the first of seed s is person(s * performers)."""
    takes: int = 1
    """Number of takes of each posture by each person."""
    seed: int = 0
    """The same seed gives the same clips, byte for byte."""
    postures: tuple[str, ...] = POSTURES
    """The postures; not requested where the motion is free or a fall."""
    cameras: int = 2
    """Number of cameras, 1 to MOST_CAMERAS."""
    moving: bool = False
    """Whether screens play, and trees sway, behind the person."""


class Filming(NamedTuple):
    """The equipment that records a motion."""

    rig: Rig
    """The cameras; files and arrays have their names."""
    room_seed: int
    seed: int
    """Seed of people, motion and noise: one seed gives the same clips, byte for byte."""
    moving: bool = False
    """Whether screens play, and trees sway, behind the person."""


def write_set(
    out: Path,
    wanted: ClipSet,
    size: tuple[int, int],
    progress: Callable[[int, int], None] | None = None,
) -> list[Path]:
    """Clips of several people, with `calibration.json` beside them.

    Args:
        out: Folder, created where missing; clips of the same names are replaced.
        wanted: Content of the clips.
        size: Width and height of the pictures.
        progress: Receives the number of finished clips, and of all.

    Returns:
        The clips' folders, in order.

    Raises:
        SynthError: When nothing would be written, a posture or the motion is unknown, or the
            calibration of other cameras would be lost.
    """
    motion, performers, takes, seed, postures, cameras, moving = wanted
    names = (motion,) if motion in ALONE else postures
    _refuse_what_cannot_be(wanted, size, names)
    rig = rig_around(size, cameras, seed)
    out.mkdir(parents=True, exist_ok=True)
    refuse_to_lose(out / "calibration.json", rig)
    write_rig(out / "calibration.json", rig)
    folders = []
    jobs = list(itertools.product(range(performers), range(1, takes + 1), names))
    for done, (number, take, posture) in enumerate(jobs, 1):
        someone = person(seed * performers + number)
        own = take + 1000 * seed
        moved = _taken(someone, own, posture, postures)
        other = person(PASSERS + seed * performers + number)
        passer = Part(other, crossing(other, own, moved)) if motion == "cross" else None
        folders.append(out / clip_name(someone, posture, take))
        filming = Filming(rig, seed * ROOM_SEED + number, own, moving)
        write_clip(folders[-1], someone, moved, filming, take, passer)
        if progress is not None:
            progress(done, len(jobs))
    return folders


def _taken(someone: Person, seed: int, posture: str, postures: tuple[str, ...]) -> Motion:
    """One take of a motion by a person."""
    if posture == "stream":
        return streamed(someone, seed, FPS, postures)
    if posture in {"spot", "cross"}:
        return on_spot(someone, seed, FPS)
    return performance(someone, posture, seed, FPS)


def clip_name(someone: Person, posture: str, take: int) -> str:
    """The folder of a clip, as `data/README.md` names them."""
    number = POSTURES.index(posture) + 1 if posture in POSTURES else 0
    return f"{someone.name}_t{take}_{number:02d}_{posture}"


def write_clip(
    folder: Path,
    someone: Person,
    motion: Motion,
    filming: Filming,
    take: int,
    passer: Part | None = None,
) -> None:
    """One clip: cam1.avi, cam2.avi, ... (Motion JPEG), meta.json, truth.npz.

    Args:
        folder: Created where missing.
        someone: The performer.
        motion: Their motion.
        filming: The equipment.
        take: Number of the take, for the metadata.
        passer: A second person, who is in the pictures and not in the truth.

    Raises:
        SynthError: When a video cannot be written there.
    """
    rig, room_seed, seed, moving = filming
    folder.mkdir(parents=True, exist_ok=True)
    if passer is None:
        shots = render(someone, motion, rig, room_seed, seed, moving)
    else:
        of_both = render_scene((Part(someone, motion), passer), rig, room_seed, seed, moving=moving)
        shots = (Shot(shot.frames, tuple(mask[0] for mask in shot.masks)) for shot in of_both)
    masks = filmed(folder, shots, rig, motion.fps)
    meta = meta_of(someone, motion, filming, take)
    (folder / "meta.json").write_text(json.dumps(meta, indent=1) + "\n")
    gain = exposures(len(masks), len(motion.phase), seed, motion.fps)
    np.savez_compressed(
        folder / "truth.npz",
        allow_pickle=False,
        **truth_of(someone, motion, rig, take),
        **masks,
        gain=gain.astype(np.float32),
    )


def write_rig(path: Path, rig: Rig) -> None:
    """A `calibration.json` that `common.rig.camera.load_rig` reads."""
    path.write_bytes(_rig_text(rig))


def _rig_text(rig: Rig) -> bytes:
    return msgspec.json.format(msgspec.json.encode(rig), indent=1)


def refuse_to_lose(path: Path, rig: Rig) -> None:
    """An existing calibration may belong to cameras that recorded other clips beside it.

    Raises:
        SynthError: Then.
    """
    if path.exists() and path.read_bytes() != _rig_text(rig):
        raise SynthError(f"{path} is of other cameras, whose clips it serves: name another --out")


def filmed(folder: Path, shots: Iterable[Shot], rig: Rig, fps: float) -> dict[str, Packed]:
    """Write every camera's video; their masks of all frames, packed along their last axis."""
    names = [camera.name for camera in rig.cameras]
    videos = [_writer(folder / f"{name}.avi", rig, fps) for name in names]
    masks: dict[str, list[Packed]] = {f"mask_{name}": [] for name in names}
    try:
        for shot in shots:
            for video, frame in zip(videos, shot.frames, strict=True):
                video.write(frame)
            for packed, mask in zip(masks.values(), shot.masks, strict=True):
                packed.append(np.packbits(mask, axis=-1))
    finally:
        for video in videos:
            video.release()
    return {name: np.stack(packed) for name, packed in masks.items()}


def _writer(path: Path, rig: Rig, fps: float) -> cv2.VideoWriter:
    code = cv2.VideoWriter.fourcc(*"MJPG")
    film = cv2.VideoWriter(str(path), code, fps, (rig.width, rig.height))
    if not film.isOpened():
        raise SynthError(f"cannot write {path}: is the folder writable, the disk full?")
    film.set(cv2.VIDEOWRITER_PROP_QUALITY, JPEG_QUALITY)
    return film


def meta_of(someone: Person, motion: Motion, filming: Filming, take: int) -> dict[str, object]:
    """What `meta.json` says of a person's take."""
    counts = np.bincount(motion.phase, minlength=4).tolist()
    return {
        "performer": someone.name,
        "posture": motion.posture,
        "posture_id": _number(motion.posture),
        "take": take,
        "room": filming.room_seed,
        "moving": filming.moving,
        "fps": motion.fps,
        "n_frames": len(motion.phase),
        "phases": dict(zip(PHASES, counts, strict=True)),
        "sex": someone.sex,
        "look": someone.look._asdict(),
        "measures": {name: round(someone.measures[name], 4) for name in MEASURE_NAMES},
        "seed": filming.seed,
        "acts": [act._asdict() for act in motion.acts],
        "style": {name: round(value, 4) for name, value in motion.style._asdict().items()},
    }


def truth_of(someone: Person, motion: Motion, rig: Rig, take: int) -> dict[str, np.ndarray]:
    """The arrays of `truth.npz` other than those from the videos."""
    count = len(motion.phase)
    return {
        "joints3d": motion.joints_m.astype(np.float32),
        "joint_names": np.array(JOINTS),
        **{f"joints2d_{camera.name}": projected(camera, motion) for camera in rig.cameras},
        "mask_shape": np.array([rig.height, rig.width]),
        "phase": motion.phase,
        "present": motion.present,
        "time": (np.arange(count) / motion.fps).astype(np.float32),
        **{f"frames_{c.name}": np.arange(count, dtype=np.int32) for c in rig.cameras},
        "angles": motion.angles_deg.astype(np.float32),
        "angle_names": np.array(ANGLES),
        "root": motion.root_m.astype(np.float32),
        "posture_id": np.array(_number(motion.posture)),
        "posture": np.array(motion.posture),
        "class5": np.array(movement(motion.posture)),
        "performer": np.array(someone.name),
        "take": np.array(take),
        "measures": measure_vector(someone),
        "measure_names": np.array(MEASURE_NAMES),
        "blurred": blurred(motion),
    }


def projected(camera: Camera, motion: Motion) -> np.ndarray:
    """Places of the joints in a camera's picture, (n, 20, 2); NaN while the room is empty."""
    pixels = project(camera, motion.joints_m.reshape(-1, 3))
    return pixels.reshape(len(motion.phase), -1, 2).astype(np.float32)


def _number(posture: str) -> int:
    """Index among the postures, -1 for another motion."""
    return POSTURES.index(posture) if posture in POSTURES else -1


def _refuse_what_cannot_be(wanted: ClipSet, size: tuple[int, int], names: tuple[str, ...]) -> None:
    motion, performers, takes, seed, _, cameras, _ = wanted
    if motion not in ("postures", *ALONE):
        raise SynthError(f"motion must be postures, {', '.join(ALONE)}, got {motion!r}")
    for what, number in (("performers", performers), ("takes", takes)):
        if number < 1:
            raise SynthError(f"{what} must be at least 1, got {number}")
    if not 1 <= cameras <= MOST_CAMERAS:
        raise SynthError(f"cameras must be 1 to {MOST_CAMERAS}, got {cameras}")
    if seed < 0:
        raise SynthError(f"seed must not be negative, got {seed}")
    if min(size) < 32 or max(size) > 4096:
        raise SynthError(f"a picture has 32 to 4096 pixels each way, got {size[0]}x{size[1]}")
    unknown = [name for name in names if name not in (*POSTURES, *ALONE)]
    if unknown or not names:
        raise SynthError(f"unknown posture {unknown or names}; known are {', '.join(POSTURES)}")
