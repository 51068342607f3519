"""The settings of one run: one frozen value, with all defaults."""

import re
from typing import Final

import msgspec

from common.config.part_settings import (
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
from common.method import Mode

LANDMARK_SOURCES: Final = ("own", "none", "mediapipe")
"""What `landmarks` may say instead of a path."""
MOST_OFFSET_S: Final = 3600.0
CAMERA_NAME: Final = re.compile(r"[A-Za-z0-9_-]{1,32}")
NETWORK: Final = ".onnx"
"""What the name of a network of ours ends in."""


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One run: where pictures come from, how they are looked at, where the processes meet."""

    room: str = "room"
    """Name of the place: part of every topic, so that two rigs can share a network."""
    mode: Mode = "default"
    clip: str = ""
    """A clip folder with cam1.*, cam2.*; environment variables are filled in."""
    calibration: str = ""
    """A calibration.json; the one beside the clip or one folder up when empty."""
    trust_calibration: bool = False
    """Go on with a calibration that no room has, and advise nothing on one that seems wrong."""
    opening: str = ""
    """A clip folder, or a settings file, that shows the person in a T before the run: the body is
    measured there. Its cameras may stand elsewhere."""
    size: str = "160x120"
    """Bound of the working picture: aspect kept."""
    landmarks: str = "own"
    """What tells the joints that the picture itself shows: the network in the package ("own"),
    nothing ("none"), "mediapipe", a network of one's own (a file that `tritrack train --what
    landmarks` wrote), or a folder of keypoint files."""
    every: int = 1
    """Take every n-th frame of a recorded clip."""
    fps: float = 0.0
    """Rate at which recorded clips are taken to run, and played; 0: what they say themselves. Of
    cameras on another host than the integrator's: theirs."""
    offset_s: float | None = None
    """How late camera 2 is, seconds: what camera 1 shows at t, camera 2 shows at t + offset_s of
    its own times. Below 0 where it was started later. None: who moves in a recorded clip tells."""
    metrics: str = ""
    """HOST:PORT at which a live run answers /metrics (Prometheus) and /healthz; nowhere when
    empty."""
    pictures: bool = False
    """Publish small pictures for the page; otherwise no picture leaves a viewer."""
    cameras: dict[str, CameraSettings] = {}
    """Each camera by its name, in their order: of a clip folder cam1, cam2 ..., else any."""
    silhouette: SilhouetteSettings = SilhouetteSettings()
    search: SearchSettings = SearchSettings()
    body: BodySettings = BodySettings()
    recognizer: RecognizerSettings = RecognizerSettings()
    page: PageSettings = PageSettings()
    bus: BusSettings = BusSettings()

    @property
    def looks_itself(self) -> bool:
        """Whether viewers look by a network of ours, the one in the package or another."""
        return self.landmarks == "own" or self.landmarks.endswith(NETWORK)

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
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
        within("every", self.every, 1, 1000)
        within("fps", self.fps, 0.0, 1000.0)
        within("offset_s", self.offset_s or 0.0, -MOST_OFFSET_S, MOST_OFFSET_S)
        if self.metrics:
            address_of(self.metrics)
