"""Joints that another tracker's landmarks of four cameras give."""

from itertools import combinations
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

AGREE: Final = 0.03
"""Focal lengths within which all cameras see a joint that they agree about: some 15 cm here."""

KNEES: Final = (("l_hip", "l_knee", "l_ankle"), ("r_hip", "r_knee", "r_ankle"))

Floats = NDArray[np.float64]


def joints_of(rig: dict[str, Any], path: Path) -> Floats:
    """Joints that a file of landmarks has of the four videos, (frames, joints, 3), metres.

    They come by linear least squares, each camera weighed by how visible it shows a joint.

    In one of the cameras that tracker exchanges sides for a while: where all do not agree, those
    three count that agree best.

    Args:
        rig: A `calibration.json` of the whole pictures.
        path: The landmarks.
    """
    cameras, whole = rig["cameras"], np.array((rig["width"], rig["height"]))
    views = []
    with np.load(path, allow_pickle=False) as given:
        for camera in cameras:
            video = f"pose2sim_balancing/{camera['name']}.mp4"
            places_px = given[video][..., :2] * (whole / given[f"{video}__size"])
            views.append(_view(camera, places_px, given[video][..., 2]))
    everyone = tuple(range(len(views)))
    best, missed = _met(views, everyone)
    agree = missed < AGREE
    least = np.where(agree, 0.0, np.inf)
    for three in combinations(everyone, len(views) - 1):
        places, missed = _met(views, three)
        better = missed < least
        best[better], least[better] = places[better], missed[better]
    return best


def _view(camera: dict[str, Any], places_px: Floats, visible: Floats) -> tuple[Floats, ...]:
    """A camera's matrix (3, 4), where it sees the joints (frames, joints, 2), and their weights."""
    lens = np.array(camera["K"]), np.array(camera["distortion"])
    flat = cv2.undistortPoints(places_px.reshape(-1, 1, 2).astype(np.float64), *lens)
    return np.column_stack([camera["R"], camera["t"]]), flat.reshape(places_px.shape), visible


def _met(views: list[tuple[Floats, ...]], used: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Joints by some views, and by how much the worst of these misses them, in focal lengths."""
    rows = [
        visible[..., None, None] * (seen[..., None] * P[2] - P[:2])
        for P, seen, visible in (views[n] for n in used)
    ]
    homogeneous = np.linalg.svd(np.concatenate(rows, axis=2))[2][..., -1, :]
    missed = []
    for P, seen, _ in (views[n] for n in used):
        shown = homogeneous @ P.T
        missed.append(np.linalg.norm(shown[..., :2] / shown[..., 2:] - seen, axis=-1))
    return homogeneous[..., :3] / homogeneous[..., 3:], np.max(missed, axis=0)


def bent_deg(joints_m: Floats, names: list[str]) -> Floats:
    """Angles of the left and the right knee, (n, 2), 180 of a straight one, of joints (n, J, 3)."""
    angles = []
    for leg in KNEES:
        hip, knee, ankle = (joints_m[:, names.index(name)] for name in leg)
        up, down = hip - knee, ankle - knee
        cosine = (up * down).sum(1) / np.linalg.norm(up, axis=1) / np.linalg.norm(down, axis=1)
        angles.append(np.degrees(np.arccos(cosine.clip(-1.0, 1.0))))
    return np.stack(angles, axis=1)
