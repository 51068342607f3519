"""How many clips are lost in rooms that deceive: people from the first frame on, camouflage, doors.

Run from the checkout: .venv/bin/python benchmarks/cruel_rooms.py FOLDER [--clips 40] [--seed 0]

FOLDER keeps the clips, made up once; a clip is lost where its joints are more than 60 mm off on
average over the frames with a person, a frame without a pose counted as 500 mm.
"""

import argparse
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from common.config.settings import Settings
from common.rig.camera import Rig, project
from lab.accuracy.accuracy import compare
from runtime.live.table import table_of_rows
from runtime.offline.lockstep import Decoders, Tracked, track_clip
from runtime.store.pose_arrays import poses
from runtime.store.runs import belief_facts
from synth.motion.motions import EMPTY, POSTURES, Motion, performance
from synth.person.people import Colour, Look, Person, person
from synth.picture.exposure import default_rig
from synth.picture.render import room_of
from synth.write import Filming, write_clip, write_rig

LOST_MM: Final = 60.0
NO_POSE_MM: Final = 500.0
KINDS: Final = ("edge", "wall", "floor", "door")
"""A cupboard's edge behind the person; clothes of the wall's colour, trousers of the floor's; a
door that moves. Every second clip of each begins with the person there."""
LIT: Final = 0.8
"""How bright cloth is rendered on average, of its own colour."""

Picture = NDArray[np.uint8]


class Cruel(NamedTuple):
    """One clip: who is in which room, and how that deceives."""

    kind: str
    occupied: bool
    """The person is there from the first frame on."""
    seed: int

    @property
    def name(self) -> str:
        """Of its folder."""
        return f"{self.seed:03d}_{self.kind}_{'occupied' if self.occupied else 'empty'}"


def cruel(number: int, seed: int) -> Cruel:
    """The clip of a number."""
    kind = KINDS[number % len(KINDS)]
    return Cruel(kind, number // len(KINDS) % 2 == 0, seed + number)


def make(folder: Path, wanted: Cruel) -> Path:
    """The clip, rendered where it is not there yet."""
    clip = folder / wanted.name
    if (clip / "truth.npz").exists():
        return clip
    rng = np.random.default_rng([wanted.seed, 90])
    rig, someone = default_rig(320, 240), person(50_000 + wanted.seed)
    moved = performance(someone, str(rng.choice(POSTURES)), wanted.seed)
    if wanted.occupied:
        moved = _from(moved, int((moved.phase == EMPTY).sum()))
    room_seed = 90_000 + wanted.seed
    if wanted.kind in ("wall", "floor"):
        room = room_of(room_seed, rig).pictures[0]
        someone = _camouflaged(someone, wanted.kind, _behind(room, rig, moved))
    new = clip.with_name(f"{clip.name}.new")
    write_clip(new, someone, moved, Filming(rig, room_seed, wanted.seed), 1)
    write_rig(new / "calibration.json", rig)
    if wanted.kind in ("edge", "door"):
        for camera in (1, 2):
            _paneled(new, camera, rig, moved, wanted)
    shutil.rmtree(clip, ignore_errors=True)
    new.rename(clip)
    return clip


def _from(moved: Motion, first: int) -> Motion:
    """A take without its first frames."""
    names = ("joints_m", "bones", "angles_deg", "root_m", "phase")
    return moved._replace(**{name: getattr(moved, name)[first:] for name in names})


def _behind(room: NDArray[np.float32], rig: Rig, moved: Motion) -> dict[str, Colour]:
    """The colours of the room behind trunk and shins, as camera 1 sees it."""
    shown = np.flatnonzero(moved.present)
    seen = project(rig.cameras[0], moved.joints_m[shown].reshape(-1, 3)).reshape(len(shown), -1, 2)
    low, high = seen[:, :, 1].min(), seen[:, :, 1].max()
    left, right = int(seen[:, 0, 0].min()) - 12, int(seen[:, 0, 0].max()) + 12
    rows = {"wall": (0.2, 0.5), "floor": (0.6, 1.0)}
    found: dict[str, Colour] = {}
    for name, (first, last) in rows.items():
        top, bottom = (int(low + share * (high - low)) for share in (first, last))
        colour = np.median(room[top:bottom, left:right].reshape(-1, 3), axis=0) / LIT
        blue, green, red = (int(value) for value in colour.clip(0, 255))
        found[name] = (blue, green, red)
    return found


def _camouflaged(someone: Person, kind: str, behind: dict[str, Colour]) -> Person:
    look = someone.look._replace(trousers=behind["floor"], shoes=behind["floor"], shorts=False)
    if kind == "wall":
        shirt = behind["wall"]
        look = look._replace(shirt=shirt, shirt_second=shirt, pattern="plain", sleeve="long")
    return someone._replace(look=Look(*look))


def _paneled(folder: Path, camera: int, rig: Rig, moved: Motion, wanted: Cruel) -> None:
    """Hang a panel behind the person: one whose edge is behind them, or one that swings."""
    rng = np.random.default_rng([wanted.seed, camera, 91])
    with np.load(folder / "truth.npz", allow_pickle=False) as truth:
        masks = np.unpackbits(truth[f"mask_cam{camera}"], axis=2)[..., : rig.width] > 0
    shown = np.flatnonzero(moved.present)
    pelvis = project(rig.cameras[camera - 1], moved.joints_m[shown[0], :1])[0]
    wide, colour = int(rng.uniform(40, 90)), rng.uniform(25, 230, 3)
    reach = rng.uniform(0.4, 0.9)
    side = int(rng.choice([-1, 1]))
    frames = []
    for i, (picture, mask) in enumerate(zip(_film(folder, camera), masks, strict=True)):
        at, open_ = pelvis[0] - (wide if side < 0 else 0), 1.0
        if wanted.kind == "door":
            away = (40 + wide) if side > 0 else -(40 + wide)
            at, open_ = pelvis[0] + away - wide / 2, _swung(i / len(masks), reach)
        frames.append(_hung(picture, mask, (at, at + wide * open_), colour, rng))
    _write(folder, camera, frames, moved.fps)


def _swung(share: float, reach: float) -> float:
    """How much of its width a door shows: shut, opened in the middle of the clip, left so."""
    return 1.0 - reach * min(max((share - 0.4) / 0.12, 0.0), 1.0)


def _hung(
    picture: Picture,
    mask: NDArray[np.bool_],
    columns: tuple[float, float],
    colour: NDArray[np.float64],
    rng: np.random.Generator,
) -> Picture:
    """The picture with a panel from the top to the floor behind whoever is in it."""
    left, right = (int(np.clip(column, 0, picture.shape[1])) for column in columns)
    floor = int(0.8 * picture.shape[0])
    panel = picture.astype(np.float32)
    shade = np.linspace(1.0, 0.85, max(right - left, 1), dtype=np.float32)[None, : right - left]
    panel[:floor, left:right] = shade[..., None] * colour
    panel[:floor, left:right] += rng.normal(0, 1.7, panel[:floor, left:right].shape)
    own = cv2.GaussianBlur(mask.astype(np.float32), (3, 3), 0)[..., None]
    own = np.maximum(own, mask[..., None])
    return np.asarray((own * picture + (1 - own) * panel).clip(0, 255), np.uint8)


def _film(folder: Path, camera: int) -> Iterator[Picture]:
    film = cv2.VideoCapture(str(folder / f"cam{camera}.avi"))
    while (read := film.read())[0]:
        yield np.asarray(read[1], np.uint8)


def _write(folder: Path, camera: int, frames: list[Picture], fps: float) -> None:
    size = (frames[0].shape[1], frames[0].shape[0])
    path = folder / f"cam{camera}.avi"
    film = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), fps, size)
    film.set(cv2.VIDEOWRITER_PROP_QUALITY, 95)
    for frame in frames:
        film.write(frame)
    film.release()


def row_of(clip: Path, tracked: Tracked) -> dict[str, Any]:
    """How far a clip's bodies are off, and how many of its frames are believed."""
    with np.load(clip / "truth.npz", allow_pickle=False) as file:
        truth = dict(file)
    compared = compare(poses(tracked.bodies), truth)
    off_mm = 1000 * np.linalg.norm(compared.tracked_m - compared.true_m, axis=2).mean(axis=1)
    due = int(truth["present"].sum())
    off_mm = np.append(off_mm, np.full(due - len(off_mm), NO_POSE_MM))
    sure = belief_facts(tracked.bodies)["believed"] or 0.0
    return {"name": clip.name, "mm": off_mm.mean(), "worst mm": off_mm.max(), "believed": sure}


def main() -> None:
    """Make the clips, follow them, tell which are lost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="keeps the clips")
    parser.add_argument("--clips", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="part of the names of the clips to follow")
    given = parser.parse_args()
    cv2.setNumThreads(1)
    given.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    with Decoders() as decoders:
        for number in range(given.clips):
            wanted = cruel(number, given.seed)
            if given.only not in wanted.name:
                continue
            clip = make(given.folder, wanted)
            settings = msgspec.structs.replace(Settings(), clip=str(clip), size="320x240")
            rows.append(row_of(clip, track_clip(settings, decoders)))
    console = Console(width=100)
    console.print(table_of_rows(rows))
    for kind in (*KINDS, ""):
        own = [row for row in rows if kind in row["name"]]
        lost = [row for row in own if row["mm"] > LOST_MM]
        sure = [row for row in lost if row["believed"] > 0.5]
        mean = np.mean([row["mm"] for row in own]) if own else 0.0
        console.print(
            f"{kind or 'all'}: {len(lost)} of {len(own)} clips lost, {len(sure)} of them believed; "
            f"{mean:.1f} mm"
        )


if __name__ == "__main__":
    main()
