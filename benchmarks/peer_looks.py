"""Another's network looks at every picture of some videos: what `side_by_side.py` measures.

    PYTHON benchmarks/peer_looks.py 320x240 VIDEO... [--lightning FILE]

By MediaPipe full, one thread of its own each video, or by MoveNet Lightning as ONNX. It imports
nothing of ours, as MediaPipe's Python may be another.
"""

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np

Look = Callable[[np.ndarray], object]


def pictures(video: str, size: tuple[int, int]) -> Iterator[np.ndarray]:
    """The pictures (H, W, 3) BGR of a video."""
    capture = cv2.VideoCapture(video)
    while True:
        is_read, picture = capture.read()
        if not is_read:
            return
        yield cv2.resize(picture, size, interpolation=cv2.INTER_AREA)


def mediapipe() -> tuple[Look, Callable[[], object]]:
    """A look of MediaPipe's full model, and what begins a video."""
    from mediapipe.python.solutions.pose import Pose

    pose = Pose(model_complexity=1, smooth_landmarks=False)
    return lambda picture: pose.process(np.ascontiguousarray(picture[:, :, ::-1])), pose.reset


def lightning(network: Path) -> tuple[Look, Callable[[], object]]:
    """A look of MoveNet Lightning at the whole picture, on one thread."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3
    session = onnxruntime.InferenceSession(network, options, providers=["CPUExecutionProvider"])
    (taken,) = session.get_inputs()
    side = int(taken.shape[1])
    number: Any = np.int32 if "int32" in taken.type else np.float32

    def look(picture: np.ndarray) -> object:
        long = max(picture.shape[:2])
        square = np.zeros((long, long, 3), np.uint8)
        square[: picture.shape[0], : picture.shape[1]] = picture[:, :, ::-1]
        shown = cv2.resize(square, (side, side))[None].astype(number)
        return session.run(None, {taken.name: shown})

    return look, lambda: None


def main() -> None:
    """Look at all."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("size")
    asked.add_argument("videos", nargs="+")
    asked.add_argument("--lightning", type=Path)
    given = asked.parse_args()
    cv2.setNumThreads(1)
    wide, high = map(int, given.size.split("x"))
    look, begin = lightning(given.lightning) if given.lightning else mediapipe()
    for video in given.videos:
        begin()
        for picture in pictures(video, (wide, high)):
            look(picture)


if __name__ == "__main__":
    main()
