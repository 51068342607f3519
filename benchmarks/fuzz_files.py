"""Files as nobody writes them, read by all that reads files: a refusal that names them, no harm.

Run from the checkout: .venv/bin/python benchmarks/fuzz_files.py CLIP [--files 10000] [--seed 0]

One whole file of each kind is made of a clip, then damaged: byte by byte, value by value where it
is JSON, array by array where it is .npz. Each damaged file is read as a user would have it read. A
refusal is an error of ours, of one line; harm is any other error, or more than ten seconds. Ends
with exit code 1 where there was harm.
"""

import argparse
import faulthandler
import io
import json
import os
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")

import cv2
import numpy as np
import psutil
from mutations import ODD, damaged, strange
from rich.console import Console

import recognizer.__main__ as recogniser
from calibration.foreign.imported_rig import imported_rig
from calibration.foreign.toml_rig import toml_text
from common.config.config_file import load
from common.config.settings import Settings
from common.notes.notes_file import load_notes
from common.rig.rig_file import load_rig
from common.video.clips import open_clip
from common.video.decoding import Decoder
from recognizer import model_file
from runtime.faults import MENDABLE, code_of
from runtime.live.table import table_of_rows
from runtime.offline.batch import Asked, track_all
from runtime.store.journal import Head, Journal
from runtime.store.past_run import open_run
from runtime.store.recording import read_recording
from tritrack.exporting import export_run
from tritrack.single.mask_file import read_masks
from viewer.landmarks.keypoint_files import people_of

WORDS = ("refused", "read", "harm")
SLOW_S = 10.0
VIDEOS = ("cam1", "cam2")


class Kind(NamedTuple):
    """A file that is read."""

    path: Path
    """Where it is read, with all that belongs to it."""
    read: Callable[[Path], object]
    whole: bytes


def write_whole(clip: Path, folder: Path) -> None:
    """A whole file of each kind, with all that belongs to it."""
    copy, run, cut_short = folder / "clip", folder / "run", folder / "cut_short"
    shutil.copytree(clip, copy)
    own = clip / "calibration.json"
    shutil.copyfile(own if own.is_file() else clip.parent / own.name, copy / own.name)
    track_all([copy], run, Asked(record=True), Console(quiet=True))
    rig, recording = load_rig(copy / own.name), read_recording(run / "clip")
    cut_short.mkdir()
    kept = Journal(cut_short, Head(settings=Settings(), facts={"clip": "clip"}))
    kept.keep([*recording.cameras, *recording.bodies, *recording.postures])
    kept.close()
    for kind in ("pose2sim", "caliscope"):
        (folder / f"{kind}.toml").write_text(toml_text(rig, kind))
    _write_opencv(folder / "opencv.yml")
    (folder / "settings.toml").write_text(
        'clip = "clip"\nevery = 2\nsize = "320x240"\n[body]\nstature_m = 1.8\n[page]\nport = 0\n'
    )
    (folder / "notes.toml").write_text(
        '[[note]]\nframe = 3\norientation = "left"\ndepth = {l_lower_arm = "toward"}\n'
        "joints_px = {l_wrist = [40.0, 30.5]}\n"
    )
    points = {"pose_keypoints_2d": [10.0, 20.0, 0.5] * 25}
    (folder / "keypoints.json").write_text(json.dumps({"version": 1.3, "people": [points] * 2}))
    np.savez(folder / "masks.npz", walk=np.ones((5, 12, 16), np.uint8))
    shutil.copyfile(recogniser.SHIPPED, folder / "model.npz")
    shutil.copyfile(recogniser.SHIPPED_PAPER, folder / "paper.npz")


def kinds(clip: Path, folder: Path, decoder: Decoder) -> dict[str, Kind]:
    """Each kind of file, one of it written whole where it can be read."""
    write_whole(clip, folder)
    copy, run = folder / "clip", folder / "run"
    settings = load(copy)

    def opened(_: Path) -> object:
        return open_clip(settings, decoder)

    def seen(path: Path) -> object:
        return list(decoder.frames(str(path), (160, 120)))

    def exported(path: Path) -> object:
        return open_run(path.parent) and export_run(path.parent, "csv", None)

    found: dict[str, tuple[Path, Callable[[Path], object]]] = {
        "settings": (folder / "settings.toml", load),
        "calibration": (copy / "calibration.json", load_rig),
        "pose2sim's": (folder / "pose2sim.toml", imported_rig),
        "caliscope's": (folder / "caliscope.toml", imported_rig),
        "opencv's": (folder / "opencv.yml", imported_rig),
        "notes": (folder / "notes.toml", load_notes),
        "keypoints": (folder / "keypoints.json", people_of),
        "masks": (folder / "masks.npz", read_masks),
        "postures": (folder / "model.npz", model_file.load),
        "paper's postures": (folder / "paper.npz", model_file.load),
        "meta": (copy / "meta.json", opened),
        "poses": (run / "clip" / "poses.npz", exported),
        "summary": (run / "clip" / "summary.json", exported),
        "recording": (run / "clip" / "recording.mcap", lambda path: read_recording(path.parent)),
        "journal": (next((folder / "cut_short").iterdir()), lambda path: open_run(path.parent)),
        "video": (next(path for path in copy.iterdir() if path.stem in VIDEOS), seen),
    }
    return {name: Kind(path, read, path.read_bytes()) for name, (path, read) in found.items()}


def _write_opencv(path: Path) -> None:
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    lens = np.array([[600.0, 0.0, 310.0], [0.0, 602.0, 245.0], [0.0, 0.0, 1.0]])
    turn = cv2.Rodrigues(np.array([0.05, -1.2, 0.02]))[0]
    nodes = {"image_width": 640, "image_height": 480, "M1": lens, "M2": lens, "R": turn}
    for name, value in (nodes | {"T": np.array([[3.0], [0.1], [2.0]])}).items():
        storage.write(name, value)
    storage.release()


def spoilt(random: np.random.Generator, name: str, whole: bytes) -> bytes:
    """A whole file damaged: its bytes, or what it says."""
    if random.random() < 0.4:
        return damaged(random, whole)
    if name.endswith(".json"):
        return json.dumps(strange(random, json.loads(whole)), default=str).encode()
    if name.endswith(".npz"):
        return _other_arrays(random, whole)
    lines = whole.split(b"\n")
    at = int(random.integers(len(lines)))
    key, equals, _ = lines[at].partition(b"=" if b"=" in lines[at] else b":")
    lines[at] = key + equals + b" " + repr(ODD[random.integers(len(ODD))]).encode()
    return b"\n".join(lines)


def _other_arrays(random: np.random.Generator, whole: bytes) -> bytes:
    """One array of another shape, kind or value, gone, or under another's name."""
    with np.load(io.BytesIO(whole), allow_pickle=False) as file:
        arrays = dict(file)
    name, other = (list(arrays)[random.integers(len(arrays))] for _ in range(2))
    one = arrays[name]
    match int(random.integers(7)):
        case 0:
            del arrays[name]
        case 1:
            arrays[name] = one[..., :-1] if one.ndim else one[None]
        case 2:
            arrays[name] = one.astype(str)
        case 3:
            arrays[name] = np.full(one.shape, [np.nan, np.inf, -1.0, 1e300][random.integers(4)])
        case 4:
            arrays[name] = arrays[other]
        case 5:
            arrays[name] = one[:0] if one.ndim else np.zeros(0)
        case _:
            arrays[name] = one.astype(np.complex64) if one.dtype.kind in "fiub" else one[None]
    kept = io.BytesIO()
    np.savez(kept, **arrays)
    return kept.getvalue()


def read(kind: Kind, content: bytes) -> str:
    """What becomes of a file with this content, of WORDS."""
    kind.path.write_bytes(content)
    began_s = time.perf_counter()
    try:
        kind.read(kind.path)
        word = "read"
    except Exception as error:
        word = "refused" if code_of(error) == MENDABLE and "\n" not in str(error) else "harm"
        if word == "harm":
            where = traceback.extract_tb(error.__traceback__)[-1]
            print(f"{kind.path.name}: {error!r:.300} at {where.filename}:{where.lineno}")
    finally:
        kind.path.write_bytes(kind.whole)
    took_s = time.perf_counter() - began_s
    if took_s > SLOW_S:
        print(f"{kind.path.name}: {took_s:.0f} s")
        return "harm"
    return word


def main() -> None:
    cv2.setNumThreads(1)
    faulthandler.enable()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clip", type=Path, help="a calibrated clip folder")
    parser.add_argument("--files", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    random, memory, before_mb = np.random.default_rng(given.seed), psutil.Process(), 0.0
    with ExitStack() as doors:
        folder = Path(doors.enter_context(tempfile.TemporaryDirectory()))
        known = kinds(given.clip, folder, doors.enter_context(Decoder()))
        counts = {name: Counter[str]() for name in known}
        for name, kind in known.items():
            assert read(kind, kind.whole) == "read", f"{name} is not read when it is whole"
        for n in range(given.files):
            name = [*known][n % len(known)]
            kind = known[name]
            counts[name][read(kind, spoilt(random, kind.path.name, kind.whole))] += 1
            if n == given.files // 10:
                before_mb = memory.memory_info().rss / 1e6
    rows = [{"name": name, **{word: counts[name][word] for word in WORDS}} for name in counts]
    Console().print(table_of_rows(rows))
    print(f"grown by {memory.memory_info().rss / 1e6 - before_mb:.0f} MB since the first tenth")
    sys.exit(1 if any(count["harm"] for count in counts.values()) else 0)


if __name__ == "__main__":
    main()
