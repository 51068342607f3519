"""Tracking results of clips, cached on disk: no clip is tracked twice in the same way."""

import hashlib
import io
import json
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.atomic_file import replacing
from common.config.settings import Settings
from common.npz_file import Arrays, Facts, read_arrays
from common.source_digest import add
from common.video.clip_sources import ClipError
from runtime.offline.lockstep import Tracked
from runtime.store.past_run import MAX_BYTES
from runtime.store.pose_arrays import poses
from runtime.unfinished.run_identity import files_of

KEPT: Final = (
    *("frame", "time_s", "angles_deg", "joints_m"),
    *("joints_px", "confidence", "status"),
)
"""Arrays of `poses.npz` for recognisers and pictures."""


class CachedRun(NamedTuple):
    """The part of a run that recognition needs."""

    facts: Facts
    """clip, performer, posture_meant, warnings, as in `summary.json`."""
    arrays: Arrays
    """KEPT, as in `poses.npz`."""


def key_of(settings: Settings, tracker: str) -> str:
    """A key for a clip tracked in one way: it changes with any file of it and any setting.

    Raises:
        ClipError: When a file is missing, or the settings name a camera.
    """
    plain = msgspec.structs.replace(settings, clip="", calibration="")
    digest = hashlib.sha256(tracker.encode())
    add(digest, "settings", msgspec.json.encode(plain))
    add(digest, "clip", Path(settings.clip).resolve().name.encode())
    for path in files_of(settings):
        try:
            add(digest, path.name, path.read_bytes())
        except OSError as error:
            raise ClipError(f"cannot read {path}: {error.strerror}; check the path") from error
    return digest.hexdigest()[:32]


def packed(tracked: Tracked) -> bytes:
    """A tracked clip's cached part, as an npz without pickle."""
    arrays = poses(tracked.bodies)
    facts = json.dumps(tracked.facts).encode()
    file = io.BytesIO()
    np.savez_compressed(
        file,
        allow_pickle=False,
        facts=np.frombuffer(facts, np.uint8),
        **{name: arrays[name] for name in KEPT},
    )
    return file.getvalue()


def write(folder: Path, key: str, content: bytes) -> None:
    """Store the result of `packed`; the file is complete or absent.

    Raises:
        OSError: When it cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / f"{key}.npz") as new:
        new.write_bytes(content)


def read(folder: Path, key: str) -> CachedRun | None:
    """The result stored under a key; None where there is none, or a damaged one."""
    try:
        held = read_arrays(folder / f"{key}.npz", MAX_BYTES)
        facts = json.loads(held["facts"].tobytes())
        return CachedRun(facts, {name: held[name] for name in KEPT})
    except (OSError, ValueError, KeyError):
        return None
