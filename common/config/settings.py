"""The settings of one run: one frozen value, with all defaults."""

import re
from typing import Final, Literal

import msgspec

from common.config.part_settings import (
    MOST_OFFSET_S,
    BodySettings,
    BusSettings,
    CameraSettings,
    PageSettings,
    RecognizerSettings,
    SearchSettings,
    SilhouetteSettings,
    within,
)
from common.config.picture_size import size_of
from common.endpoint import address_of
from common.method import METHODS, Mode

LANDMARK_SOURCES: Final = ("own", "none", "mediapipe")
"""Values of `landmarks` that are not paths."""
CAMERA_NAME: Final = re.compile(r"[A-Za-z0-9_-]{1,32}")
NETWORK: Final = ".onnx"
"""Suffix of a landmark network's file."""


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run: source of the pictures, how they are processed, where the processes connect."""

    room: str = "room"
    """Name of the site: part of every topic, so that two rigs can share a network."""
    mode: Mode = "default"
    """"default": our method; "paper" and "thesis": those of the two documents, to compare."""
    clip: str = ""
    """A clip folder with cam1.*, cam2.*; environment variables are replaced."""
    calibration: str = ""
    """Path of a calibration.json; where empty, the one beside the clip or one folder up."""
    trust_calibration: bool = False
    """True: accept a calibration that no room has, and give no advice on one that seems wrong."""
    opening: str = ""
    """A clip folder, or a settings file, that shows the person in a T pose before the run: the
    body is measured there. Its cameras may stand elsewhere."""
    size: str = "160x120"
    """Bound of the working picture; the aspect ratio is kept. For upright videos it is turned:
    `320x240` allows them 240x320."""
    landmarks: str = "own"
    """Source of the landmarks: the network in the package ("own"), no source ("none"),
    "mediapipe", another network (a file that `tritrack train --what landmarks` wrote), or a
    folder of keypoint files."""
    people: Literal[1, "all"] = 1
    """1: one person is followed; "all": everyone in view, each with a number."""
    every: int = 1
    """Process every n-th frame of a recorded clip."""
    fps: float = 0.0
    """Frame rate at which recorded clips are taken and played, Hz; 0: the rate in the file. For
    cameras on another host than the integrator's: their rate."""
    offset_s: float | None = None
    """Delay of camera 2, seconds: what camera 1 shows at t, camera 2 shows at t + offset_s of
    its own times. Negative where camera 2 was started later. None: estimated from the moving
    person of a recorded clip. That of another camera is its own `offset_s`."""
    metrics: str = ""
    """HOST:PORT at which a live run answers /metrics (Prometheus) and /healthz; nowhere where
    empty."""
    pictures: bool = False
    """True: publish small pictures for the page; otherwise no picture leaves a viewer."""
    cameras: dict[str, CameraSettings] = {}
    """The cameras by name, in order: cam1, cam2 ... of a clip folder, else any names."""
    silhouette: SilhouetteSettings = SilhouetteSettings()
    search: SearchSettings = SearchSettings()
    body: BodySettings = BodySettings()
    recognizer: RecognizerSettings = RecognizerSettings()
    page: PageSettings = PageSettings()
    bus: BusSettings = BusSettings()

    @property
    def looks_itself(self) -> bool:
        """Whether viewers use a landmark network of ours, in the package or in a file."""
        return self.landmarks == "own" or self.landmarks.endswith(NETWORK)

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        if not self.room or set(self.room) & set("/*$#? "):
            raise ValueError(f"room must be a plain word, got {self.room!r}")
        size_of(self.size)
        for name in self.cameras:
            if not CAMERA_NAME.fullmatch(name):
                raise ValueError(
                    f"a camera's name is up to 32 of A-Z a-z 0-9 _ and -, got {name!r}"
                )
        if not self.landmarks:
            raise ValueError(
                f"landmarks must be {', '.join(LANDMARK_SOURCES)} or a folder or network"
            )
        if self.silhouette.background == "none":
            self._refuse_no_sight()
        if self.people == "all" and not (self.looks_itself and METHODS[self.mode].landmarks):
            raise ValueError(
                'people = "all" needs mode default and a landmark network of ours: leave mode '
                "and landmarks out, or follow one person"
            )
        within("every", self.every, 1, 1000)
        within("fps", self.fps, 0.0, 1000.0)
        within("offset_s", self.offset_s or 0.0, -MOST_OFFSET_S, MOST_OFFSET_S)
        if self.metrics:
            address_of(self.metrics)

    def _refuse_no_sight(self) -> None:
        """Without a background only landmarks show a person, which the documents' methods lack."""
        if self.landmarks == "none" or not METHODS[self.mode].landmarks:
            raise ValueError(
                "without a background only landmarks show a person: have background learnt, or "
                "mode default with landmarks"
            )
