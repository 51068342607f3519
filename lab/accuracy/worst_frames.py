"""Pictures of the worst frames: both cameras' pictures, the tracked stick figure and the true
one."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import msgspec
import numpy as np

from common.body.body import Vector
from common.bus.messages import place_in_rig
from common.config.settings import Settings
from common.npz_file import Arrays, Facts
from common.rig.camera import project
from common.video.clip_facts import ClipView, whole_rig
from common.video.clips import open_clip
from common.video.pictures import Image
from lab.accuracy.accuracy import INDEX, JOINTS, Compared
from runtime.offline.lockstep import Decoders
from viewer.capture import recorded

MOST: Final = 10
"""Number of frames shown."""
APART: Final = 10
"""Distance of shown frames in a clip: neighbours have the same fault."""
SHOWN: Final = "4096x4096"
"""Bound of the pictures' size: the recorded one."""
HEIGHT_PX: Final = 480
"""Height of a shown picture, pixels; small ones are enlarged, so that limbs are visible."""

STICKS: Final = (
    ("l_shoulder", "r_shoulder"),
    ("l_hip", "r_hip"),
    *((f"{side}_shoulder", f"{side}_hip") for side in "lr"),
    *((f"{side}_shoulder", f"{side}_elbow") for side in "lr"),
    *((f"{side}_elbow", f"{side}_wrist") for side in "lr"),
    *((f"{side}_hip", f"{side}_knee") for side in "lr"),
    *((f"{side}_knee", f"{side}_ankle") for side in "lr"),
)
TRUE: Final = ((130, 255, 170), (40, 150, 40))
TRACKED: Final = ((255, 140, 60), (60, 90, 255))
"""Blue, green, red of the left and the right side: exchanged sides must be visible."""
FINE: Final = 4
"""Fractional bits of a pixel in OpenCV's drawing functions."""


class WorstFrame(NamedTuple):
    """A frame with a large error."""

    clip: str
    place: int
    """Index among the clip's compared frames."""
    frame: int
    """Frame of camera 1's video."""
    mean_mm: float
    """Mean error of its joints."""
    joint: str
    """Name of the joint with the largest error."""
    joint_mm: float


def worst(clips: Mapping[str, Compared], most: int = MOST) -> list[WorstFrame]:
    """The frames with the largest mean error, at most one within any APART frames of a clip."""
    mean = [
        (float(off), name, place)
        for name, clip in clips.items()
        for place, off in enumerate(clip.off_mm.mean(axis=1))
    ]
    found: list[WorstFrame] = []
    for off, name, place in sorted(mean, key=lambda one: (-one[0], *one[1:])):
        at = int(clips[name].frames[place])
        if any(one.clip == name and abs(one.frame - at) < APART for one in found):
            continue
        joints = clips[name].off_mm[place]
        most_off = int(joints.argmax())
        found.append(WorstFrame(name, place, at, off, JOINTS[most_off], float(joints[most_off])))
        if len(found) == most:
            break
    return found


def draw(
    frames: Sequence[WorstFrame],
    clips: Mapping[str, Compared],
    truths: Mapping[str, Arrays],
    settings: Mapping[str, Settings],
    out: Path,
    decoders: Decoders,
) -> list[Facts]:
    """Write a picture of each frame; returns its description.

    Args:
        frames: Result of `worst`.
        clips: The compared clips, by name.
        truths: Content of `truth.npz`, by clip.
        settings: Settings of the runs, by clip.
        out: Output folder.
        decoders: Read the videos.

    Raises:
        ClipError: When a clip cannot be used.
        OSError: When a picture cannot be written.
    """
    told = []
    for number, one in enumerate(frames, 1):
        picture = _shown(one, clips[one.clip], truths[one.clip], settings[one.clip], decoders)
        name = f"worst_{number:02d}.png"
        (out / name).write_bytes(cv2.imencode(".png", picture)[1].tobytes())
        told.append({**one._asdict(), "picture": name})
    return told


def _shown(
    one: WorstFrame, compared: Compared, truth: Arrays, settings: Settings, decoders: Decoders
) -> Image:
    clip = open_clip(msgspec.structs.replace(settings, size=SHOWN), decoders.of[1])
    rig, row, parts = whole_rig(clip), int(compared.rows[one.place]), []
    for view in clip.views:
        row_of = truth.get(f"frames_cam{view.number}", np.arange(len(truth["present"])))
        picture, enlarged = _taken(view, int(np.abs(row_of - row).argmin()), decoders)
        if rig is not None:
            camera = rig.cameras[place_in_rig(view.number)]
            true, tracked = (
                enlarged * project(camera, joints[one.place])
                for joints in (compared.true_m, compared.tracked_m)
            )
            stick(picture, true, TRUE)
            stick(picture, tracked, TRACKED)
        parts.append(picture)
    return np.concatenate(parts, axis=1)


def _taken(view: ClipView, index: int, decoders: Decoders) -> tuple[Image, float]:
    """A frame of a video at HEIGHT_PX, and its enlargement."""
    last = None
    for frame in recorded(view, 1, decoders.of[view.number]):
        last = frame.picture
        if frame.index >= index:
            break
    assert last is not None
    enlarged = HEIGHT_PX / view.size[1]
    size = (round(view.size[0] * enlarged), HEIGHT_PX)
    return cv2.resize(last, size, interpolation=cv2.INTER_CUBIC), enlarged


def stick(picture: Image, at_px: Vector, colours: Sequence[Sequence[int]]) -> None:
    """Draw a person as lines between joints (12, 2), in place; left and right in their colours."""
    for start, end in STICKS:
        ends = at_px[[INDEX[start], INDEX[end]]]
        if not np.isfinite(ends).all() or np.abs(ends).max() > 2 * max(picture.shape):
            continue
        one, other = np.rint((ends - 0.5) * 2**FINE).astype(int).tolist()
        colour = colours[int(end.startswith("r_"))]
        cv2.line(picture, one, other, colour, 2, cv2.LINE_AA, FINE)
