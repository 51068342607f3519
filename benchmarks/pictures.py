"""Joints of the network of landmarks in photographs, with and without the person's box.

Run from the checkout: .venv/bin/python benchmarks/pictures.py FOLDER --out PREDICTIONS.npz

FOLDER holds photographs and `joints.npz`: `name` (n,), `box` (n, 4) px and `joint_names`. The file
gets `box` and `whole`, each (n, 12, 2) px in the order of `joint_names`, and their confidences
(n, 12); NaN where no person is found. With a box the network sees the picture cut to that box and a
fifth of its longer side around it. `ms` (2,) is the mean processor time of a picture, all looks
counted, with and without the box. The network and its looking policy are those of the viewer.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.video.pictures import Image
from viewer.landmarks.landmark_looks import SHIPPED
from viewer.landmarks.own_landmarks import LandmarkModel, found_anywhere, found_between

AROUND: Final = 0.2
"""Of a box's longer side: what is kept around the box."""
NO_PERSON: Final = 0.5
"""A picture that is surer than this to hold no person gets no answer."""
MARKS: Final = [("left_", "l_"), ("right_", "r_")]
"""How photographs' joint names begin, and how ours do."""
Array = NDArray[np.float64]


class Predicted(NamedTuple):
    """The joints of all pictures in one mode."""

    joints_px: Array
    """(n, 12, 2)"""
    confidence: Array
    """(n, 12)"""
    ms: float


def cut_to_box(picture: Image, box: Array) -> tuple[Image, Array]:
    """The part of a picture about a box, and where its top left corner is, px.

    Args:
        picture: (H, W, 3)
        box: (4,) left, top, right, bottom.
    """
    around = AROUND * float((box[2:] - box[:2]).max())
    left, top = np.maximum(np.floor(box[:2] - around), 0).astype(int).tolist()
    right, bottom = np.ceil(box[2:] + around).astype(int).tolist()
    return picture[top:bottom, left:right], np.array([left, top], np.float64)


def in_box(picture: Image, box: Array, model: LandmarkModel) -> tuple[Landmarks, float]:
    """The person of a box, in pixels of the cut picture, and how probably there is none."""
    part, corner = cut_to_box(picture, box)
    return found_between(part, box.reshape(2, 2) - corner, 0.0, model)


def predicted(
    look: Callable[[int], tuple[Landmarks, float]], corners: Array, at: list[int]
) -> Predicted:
    """The answers of one mode.

    Args:
        look: Looks at the picture of a number.
        corners: (n, 2) where the top left pixel of what it looks at is in the picture.
        at: Places of the wanted joints in JOINT_NAMES.
    """
    joints, confidence, spent_s = [], [], 0.0
    for number, corner in enumerate(corners):
        began_s = time.process_time()
        found, nobody = look(number)
        spent_s += time.process_time() - began_s
        missed = np.nan if nobody > NO_PERSON else 0.0
        joints.append(np.array(found.joints_px)[at] + corner + missed)
        confidence.append(np.array(found.confidence)[at])
    return Predicted(np.array(joints), np.array(confidence), 1e3 * spent_s / len(corners))


def places_of(names: list[str]) -> list[int]:
    """Where joints of other names are in JOINT_NAMES."""
    for other, own in MARKS:
        names = [name.replace(other, own) for name in names]
    return [JOINT_NAMES.index(name) for name in names]


def main() -> None:
    """Look at all pictures of a folder and write what is seen."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--network", type=Path, default=SHIPPED)
    parser.add_argument("--once", action="store_true", help="do not look in the mirror too")
    given = parser.parse_args()
    marks = np.load(given.folder / "joints.npz")
    model, boxes = LandmarkModel(given.network, not given.once), marks["box"].astype(np.float64)
    files = [given.folder / f"{str(name).removesuffix('.jpg')}.jpg" for name in marks["name"]]
    pictures = [np.asarray(cv2.imread(str(file)), np.uint8) for file in files]
    at = places_of([str(name) for name in marks["joint_names"]])
    corners = np.array([cut_to_box(*pair)[1] for pair in zip(pictures, boxes, strict=True)])
    found_anywhere(pictures[0], model)
    box = predicted(lambda n: in_box(pictures[n], boxes[n], model), corners, at)
    whole = predicted(lambda n: found_anywhere(pictures[n], model), np.zeros_like(corners), at)
    np.savez(
        given.out,
        box=box.joints_px,
        box_confidence=box.confidence,
        whole=whole.joints_px,
        whole_confidence=whole.confidence,
        ms=np.array([box.ms, whole.ms]),
    )
    print(f"{len(files)} pictures, {box.ms:.1f} ms each in boxes, {whole.ms:.1f} ms without")


if __name__ == "__main__":
    main()
