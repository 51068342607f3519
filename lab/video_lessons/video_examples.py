"""A video's frames as examples: the window around the person, and the teacher's joints."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.observation import Landmarks
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.method import DEFAULT
from common.raster.similarity import Mask
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import Image
from lab.landmark_lessons.picture_store import is_drawn, store
from lab.training.training import TrainingError
from runtime.terminal import Tell
from synth.picture.picture_examples import FRAME, FRAMED, SIDE_PX, PictureExample
from viewer import track
from viewer.capture import recorded
from viewer.landmarks.landmark_sources import outside_sources
from viewer.landmarks.landmark_window import Window, planes_of
from viewer.room.background_source import background_of_film
from viewer.room.body_region import body_region, stature_px

SIZE: Final = "640x480"
"""Bound of the picture from which windows are cut."""
MOST: Final = 3000
"""Number of examined frames of one video, evenly spaced."""
TAUGHT, FEWEST = 0.5, 8
"""Confidence of the teacher above which a joint is used, and the fewest such joints of a frame."""
HELD_SHARE: Final = 0.2
"""Share of a video at its end that is held out: it shows whether the network improves."""
ASIDE: Final = 0.04
"""Standard deviation of the person's middle from the window's, in sides."""
ELSEWHERE: Final = -1000.0
"""Place of an unused joint: outside any window."""


class Looked(NamedTuple):
    """Examples from one video."""

    learnt: Path
    """A folder of examples for `PictureStore`."""
    held: Path
    """Another one, of its last fifth."""


def looked_through(film: Path, teacher: str, folder: Path, tell: Tell) -> Looked:
    """Extract the examples of a video with its teacher, unless that was done before.

    Args:
        film: A video of a static camera.
        teacher: An outside source of landmarks as in the settings: `mediapipe`, or a folder.
        folder: Stores the examples.
        tell: Receives the progress.

    Raises:
        TrainingError: When the teacher sees no person.
        SettingsError: When the teacher cannot be used.
        ClipError, Undecodable, DecoderDied: When the video cannot be used.
    """
    looked = Looked(folder / "learnt", folder / "held")
    if not (is_drawn(looked.learnt) and is_drawn(looked.held)):
        examples = list(_examples(film, teacher, tell))
        learnt = round((1.0 - HELD_SHARE) * len(examples))
        if not 0 < learnt < len(examples):
            raise TrainingError(f"{film}: {teacher} sees no person there: leave it out")
        for part, own in ((looked.learnt, examples[:learnt]), (looked.held, examples[learnt:])):
            store(part, own)
    tell(1.0)
    return looked


def _examples(film: Path, teacher: str, tell: Tell) -> Iterator[PictureExample]:
    camera = CameraSettings(source=str(film))
    settings = Settings(cameras={"cam1": camera}, landmarks=teacher, size=SIZE)
    rng = np.random.default_rng(97)
    with Decoder() as decoder:
        clip = open_clip(settings, decoder, (1,))
        view = clip.views[0]
        room = background_of_film(view, settings.silhouette, decoder)
        setup = track.Setup(1, None, settings, DEFAULT, alone=True)
        state = track.init(setup, room.background, patches=room.patches)
        every = max(1, math.ceil(view.frames / MOST))
        with outside_sources(settings, clip.views) as sources:
            for frame in recorded(view, every, decoder, sources[1]):
                state, seen, mask = track.look(state, frame, None)
                tell(frame.index / max(view.frames, 1))
                if state.landmarks.known is not None and not seen.fault:
                    yield from example_of(frame.picture, mask, state.landmarks.known, rng)


def example_of(
    picture: Image, mask: Mask, shown: Landmarks, rng: np.random.Generator
) -> Sequence[PictureExample]:
    """The example of a frame. The whole window counts as the person, for want of a better mask.
    None where the teacher is sure of too little.

    Args:
        picture: (H, W, 3)
        mask: (H, W) the silhouette; an empty one is replaced by one drawn around the joints.
        shown: The teacher's landmarks.
        rng: Source of the random framing.
    """
    sure = np.array(shown.confidence) > TAUGHT
    tall_px = stature_px(shown)
    if sure.sum() < FEWEST or not tall_px:
        return ()
    joints_px = np.array(shown.joints_px)
    outline = mask if mask.any() else body_region(shown, picture.shape, 0.0).view(np.bool_)
    window = _framed(joints_px[sure], rng)
    planes = planes_of(picture, outline, window, SIDE_PX)[0]
    scale = SIDE_PX / window.side
    places = np.where(sure[:, None], scale * (joints_px - (window.left, window.top)), ELSEWHERE)
    body = np.full((SIDE_PX, SIDE_PX, 4), 255, np.uint8)
    body[..., :3] = planes[:3].transpose(1, 2, 0)
    return (
        PictureExample(
            body,
            (planes[3] > 127).astype(np.uint8),
            places.astype(np.float32),
            np.zeros(2, np.float32),
            scale * tall_px,
        ),
    )


def _framed(joints_px: NDArray[np.float64], rng: np.random.Generator) -> Window:
    """A window around joints, framed as for synthetic people."""
    low, high = joints_px.min(axis=0), joints_px.max(axis=0)
    side = max(8.0, float((high - low).max()) * FRAMED * math.exp(rng.uniform(*FRAME)))
    middle = (low + high) / 2 + ASIDE * side * rng.normal(0.0, 1.0, 2)
    left, top = np.rint(middle - side / 2).astype(int).tolist()
    return Window(left, top, round(side))
