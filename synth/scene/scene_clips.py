"""Scenes on disk: clips whose truth has a row for each frame and person."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.bus.messages import MOST_PEOPLE
from common.npz_file import Arrays
from common.rig.camera import Rig
from synth.motion.motions import Motion
from synth.picture.exposure import exposures
from synth.picture.random_rig import MOST_CAMERAS, rig_around, stood_back
from synth.picture.render import render_scene, room_of
from synth.scene.beats import CROWD
from synth.scene.floor import inside
from synth.scene.people_scene import Scene, SceneSeed, scene
from synth.write import (
    FPS,
    ROOM_SEED,
    Filming,
    SynthError,
    filmed,
    meta_of,
    projected,
    refuse_to_lose,
    truth_of,
    write_rig,
)

PER_PERSON: Final = ("measures", "performer")
"""Arrays of the truth with one row per person."""
SHOWN: Final = 0.5
"""Share of a person's joints that a picture contains when the person is in it."""
STEP_BACK: Final = 0.12
"""Share of their distance by which cameras stand back for each person of a crowd."""
SCENE_S: Final = 10.0
"""Duration of a scene where none is given."""
LASTS_S: Final = (3.0, 600.0)
"""Range of it."""


class SceneSet(NamedTuple):
    """Content of a set of scenes."""

    people: int
    """1 to MOST_PEOPLE."""
    lasts_s: float = SCENE_S
    takes: int = 1
    """Number of scenes, each of other people in another room."""
    seed: int = 0
    """The same seed gives the same scenes, byte for byte."""
    cameras: int = 2
    """1 to MOST_CAMERAS."""
    opening: bool = True
    """Whether they begin with the empty room and T-poses; False: people are there and move from
    the first frame."""
    alone: bool = False
    """Whether each person is also shown alone, in a clip of their own with the same motion, room
    and noise: what tracking loses by the others is the difference."""
    postures: tuple[str, ...] = ()
    """What everybody performs again and again, by person, in turn; empty: random plots."""
    first_take: int = 1
    """Number of the first scene; it decides the first beat."""


def write_scenes(
    out: Path,
    wanted: SceneSet,
    size: tuple[int, int],
    progress: Callable[[int, int], None] | None = None,
) -> list[Path]:
    """Scenes of several people, with `calibration.json` beside them.

    Args:
        out: Folder, created where missing; clips of the same names are replaced.
        wanted: Content of the scenes.
        size: Width and height of the pictures.
        progress: Receives the number of finished scenes, and of all.

    Returns:
        The clips' folders, in order.

    Raises:
        SynthError: When a number is out of its range, people find no room, or the calibration of
            other cameras would be lost.
    """
    _refuse_what_cannot_be(wanted, size)
    rig = rig_of(wanted, size)
    out.mkdir(parents=True, exist_ok=True)
    refuse_to_lose(out / "calibration.json", rig)
    write_rig(out / "calibration.json", rig)
    folders = []
    for done, take in enumerate(range(wanted.first_take, wanted.first_take + wanted.takes), 1):
        folders.append(out / scene_name(wanted.people, wanted.seed, take))
        room_seed = wanted.seed * ROOM_SEED + take
        first = (*wanted[:2], wanted.seed, take, room_seed)
        asked = SceneSeed(*first, wanted.opening, wanted.postures)
        made, filming = _made(asked, rig), Filming(rig, room_seed, take + 1000 * wanted.seed)
        _write_scene(folders[-1], made, filming, take)
        if wanted.alone:
            folders += _write_each(folders[-1], made, filming, take)
        if progress is not None:
            progress(done, wanted.takes)
    return folders


def scene_name(people: int, seed: int, take: int) -> str:
    """Name of a scene's folder."""
    return f"people{people}_s{seed:02d}_t{take}"


def rig_of(wanted: SceneSet, size: tuple[int, int]) -> Rig:
    """The cameras of a set; those of a crowd stand back, for room."""
    crowd = max(0, wanted.people - CROWD + 1)
    return stood_back(rig_around(size, wanted.cameras, wanted.seed), STEP_BACK * crowd)


def _made(asked: SceneSeed, rig: Rig) -> Scene:
    try:
        return scene(asked, rig, FPS)
    except ValueError as error:
        raise SynthError(str(error)) from error


def _write_each(folder: Path, made: Scene, filming: Filming, take: int) -> list[Path]:
    """Each person of a scene alone, beside it."""
    folders = []
    for number, part in enumerate(made.parts):
        folders.append(folder.with_name(f"{folder.name}_alone{number}"))
        _write_scene(folders[-1], Scene((part,), (), ()), filming, take)
    return folders


def _write_scene(folder: Path, made: Scene, filming: Filming, take: int) -> None:
    rig, room_seed, seed, _ = filming
    folder.mkdir(parents=True, exist_ok=True)
    shots = render_scene(made.parts, rig, room_seed, seed, made.things)
    masks = filmed(folder, shots, rig, FPS)
    (folder / "meta.json").write_text(json.dumps(_meta(made, filming, take), indent=1) + "\n")
    gain = exposures(len(rig.cameras), len(made.parts[0].motion.phase), seed, FPS)
    truths = []
    for number, (someone, motion) in enumerate(made.parts):
        own = {name: packed[:, number] for name, packed in masks.items()}
        present = in_pictures(motion, rig, room_seed)
        truths.append({**truth_of(someone, motion, rig, take), "present": present, **own})
    np.savez_compressed(
        folder / "truth.npz", allow_pickle=False, **together(truths), gain=gain.astype(np.float32)
    )


def together(truths: Sequence[Arrays]) -> Arrays:
    """The truths of several people as one: rows by frame, then person, with `frame` and `person`
    for each; that of one person as it is.

    Args:
        truths: Content of `truth.npz` of each person alone, the same frames in all.
    """
    first = truths[0]
    if len(truths) == 1:
        return first
    count, people = len(first["present"]), len(truths)
    found = {
        "frame": np.repeat(np.arange(count, dtype=np.int64), people),
        "person": np.tile(np.arange(people, dtype=np.int64), count),
    }
    for name, array in first.items():
        if name in PER_PERSON:
            found[name] = np.stack([truth[name] for truth in truths])
        elif name.startswith("frames_") or np.ndim(array) == 0 or len(array) != count:
            found[name] = array
        else:
            rows = np.stack([truth[name] for truth in truths], axis=1)
            found[name] = rows.reshape(count * people, *rows.shape[2:])
    return found


def in_pictures(motion: Motion, rig: Rig, room_seed: int) -> NDArray[np.bool_]:
    """Whether the person is in the room and in a camera's picture in each frame, (n,), hidden by
    others or not."""
    there = motion.present.copy()
    there[there] = inside(room_of(room_seed, rig), motion.root_m[there][:, [0, 2]])
    shown = np.zeros(len(there), np.bool_)
    for camera in rig.cameras:
        pixels = np.nan_to_num(projected(camera, motion), nan=-1.0)
        within = ((pixels >= 0.0) & (pixels <= (rig.width, rig.height))).all(axis=2)
        shown |= within.mean(axis=1) > SHOWN
    return there & shown


def _meta(made: Scene, filming: Filming, take: int) -> dict[str, Any]:
    """What describes a scene: of the clip, of each person, and who touches whom."""
    each = [meta_of(*part, filming, take) for part in made.parts]
    of_all = {
        name: each[0][name] for name in ("posture", "take", "room", "fps", "n_frames", "seed")
    }
    if len(each) == 1:
        return each[0]
    people = [{name: one[name] for name in one if name not in of_all} for one in each]
    contacts = [contact._asdict() for contact in made.contacts]
    return {**of_all, "posture_id": -1, "people": people, "contacts": contacts}


def _refuse_what_cannot_be(wanted: SceneSet, size: tuple[int, int]) -> None:
    ranges = (
        ("people", wanted.people, 1, MOST_PEOPLE),
        ("cameras", wanted.cameras, 1, MOST_CAMERAS),
        ("seconds", wanted.lasts_s, *LASTS_S),
    )
    for what, number, low, high in ranges:
        if not low <= number <= high:
            raise SynthError(f"{what} must be {low:g} to {high:g}, got {number:g}")
    least = (("takes", wanted.takes, 1), ("take", wanted.first_take, 1), ("seed", wanted.seed, 0))
    for what, number, low in least:
        if number < low:
            raise SynthError(f"{what} must be at least {low}, got {number}")
    if min(size) < 32 or max(size) > 4096:
        raise SynthError(f"a picture has 32 to 4096 pixels each way, got {size[0]}x{size[1]}")
