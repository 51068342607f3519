"""The child that looks by MediaPipe.

It shares the memory of one picture with the viewer, which writes a frame's number on a line when
the picture of that frame is there. It answers each line with the points of the person in it.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from common.platform.platform import Answers, Asker
from viewer.landmarks.mediapipe_protocol import (
    NOBODY,
    POINTS,
    READY,
    REFUSED,
    encoded,
)

if TYPE_CHECKING:
    from mediapipe.python.solutions.pose import Pose

FULL = 1
"""The full one of MediaPipe's three models: the only one that its wheel carries."""


def main(asker: Asker) -> None:
    """Answer until the asker is gone."""
    assert asker.picture is not None
    answers = asker.answers
    try:
        pose = opened()
    except Exception as error:  # whatever keeps a foreign package from its work is for the user
        say(answers, encoded(REFUSED, text=f"{type(error).__name__}: {error}"))
        return
    say(answers, encoded(READY))
    for line in asker.requests:
        points = looked(pose, asker.picture)
        kind = NOBODY if points is None else POINTS
        say(answers, encoded(kind, int(line), points))


def opened() -> "Pose":
    """MediaPipe's pose estimator, which follows one person from frame to frame."""
    from mediapipe.python.solutions.pose import Pose

    return Pose(model_complexity=FULL, smooth_landmarks=False)


def looked(pose: "Pose", picture: NDArray[np.uint8]) -> NDArray[np.float32] | None:
    """The 33 points of the person in a picture (H, W, 3) BGR; None where no person is seen.

    Returns:
        (33, 3): column and row in pixels, and visibility.
    """
    found = pose.process(np.ascontiguousarray(picture[:, :, ::-1])).pose_landmarks
    if found is None:
        return None
    height, width = picture.shape[:2]
    points = [(p.x * width, p.y * height, p.visibility) for p in found.landmark]
    return np.array(points, np.float32)


def say(answers: Answers, answer: bytes) -> None:
    """Send one answer at once."""
    answers.write(answer)
    answers.flush()
