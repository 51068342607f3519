"""The settings of each part of a run: camera, silhouette, search, body, recogniser, page, bus."""

import math
from typing import Final, Literal

import msgspec

from common.endpoint import is_endpoint, is_exposed, is_host

MOST_OFFSET_S: Final = 3600.0
"""Largest delay of a camera, seconds."""
MOST_SESSION: Final = 64
"""Characters allowed in a session's word, which goes with every message."""

PAPER_HZ: Final = 15.0
"""Frame rate of the older settings that count frames, Hz (P1)."""
AUTO: Final = "auto"
"""The endpoint that a live run chooses itself."""


class SettingsError(ValueError):
    """Invalid settings: the text names the file, the place and the cure."""


def within(name: str, value: float, low: float, high: float) -> None:
    """Refuse a number outside its bounds.

    Raises:
        ValueError: It names the value.
    """
    if not low <= value <= high:
        raise ValueError(f"{name} must be from {low} to {high}, got {value}")


class CameraSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Source of one view's frames."""

    source: str = ""
    """Path of a video file; environment variables are replaced."""
    device: int = -1
    """Index of a camera of this host; -1: none."""
    background: str = ""
    """Path of a picture of the empty background, or of a video of it."""
    calibrated_as: str = ""
    """Name of the camera in the calibration; its position in the file where empty."""
    offset_s: float | None = None
    """Delay of this camera against camera 1, seconds: what camera 1 shows at t, it shows at
    t + offset_s of its own times. None: estimated."""

    def __post_init__(self) -> None:
        """Refuse a view with two sources, and an offset of hours."""
        within("offset_s", self.offset_s or 0.0, -MOST_OFFSET_S, MOST_OFFSET_S)
        if self.source and self.device >= 0:
            raise ValueError(f"source and device are both set: {self.source}, {self.device}")


class SilhouetteSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How a person is distinguished from the background (P3)."""

    background: Literal["learnt", "none"] = "learnt"
    """"none": there is no model of the background; the landmark network alone shows the person."""
    empty_s: float = 0.5
    """Seconds at the start of a clip that show the empty background; if a person stands there
    already, the background is estimated from the whole clip instead."""
    empty_frames: int = 0
    """Older form of `empty_s`: a number of frames at 15 Hz."""
    min_height_share: float = 0.15
    """A region smaller than this share of the picture is no person."""

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        within("empty_frames", self.empty_frames, 0, 1000)
        if self.empty_frames:
            msgspec.structs.force_setattr(self, "empty_s", self.empty_frames / PAPER_HZ)
            msgspec.structs.force_setattr(self, "empty_frames", 0)
        within("empty_s", self.empty_s, 0.01, 100.0)
        within("min_height_share", self.min_height_share, 0.01, 1.0)


class SearchSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The overlapped tritree's widths (P41), degrees."""

    arm_window_deg: int = 64
    """Width of the first window of an arm's turn."""
    leg_window_deg: int = 32
    """Width of the first window of a leg's turn."""
    stop_deg: int = 4
    """Width at which a window is no longer halved."""

    def __post_init__(self) -> None:
        """Widths that halve down to the stop on whole degrees keep the grid exact (P36)."""
        for name in ("arm_window_deg", "leg_window_deg"):
            ratio = getattr(self, name) / self.stop_deg if self.stop_deg > 0 else 0.0
            if ratio < 2 or math.log2(ratio) % 1:
                raise ValueError(
                    f"{name} must be stop_deg times 2, 4, 8 ..., got {getattr(self, name)}"
                )


class BodySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Assumptions about the person until measured."""

    stature_m: float = 1.75
    """Stature, metres: used where no calibration gives the scale, and before the body is
    measured."""
    opening_frames: int = 3
    """Number of accepted frames of the opening posture whose median makes the BDPs."""

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        within("stature_m", self.stature_m, 0.5, 2.6)
        within("opening_frames", self.opening_frames, 1, 100)


class RecognizerSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How postures are recognised."""

    model: str = ""
    """Path of a model that `tritrack train` wrote; the one in the package where empty."""
    window_frames: int = 40
    """Length of the window that is judged at each frame, frames (section 5: about 40) at 15 Hz,
    the recogniser's own rate for any camera."""

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        within("window_frames", self.window_frames, 5, 600)


class PageSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The live page."""

    port: int = 8080
    """Port of this machine that it is opened on; 0: no page."""
    wait: bool = True
    """True: a recorded clip waits for the page to be opened, for half a minute at most."""
    save_lost: bool = False
    """True: whenever a followed person is lost, the last 15 s are saved as a run folder."""
    host: str = "127.0.0.1"
    """Address that the page listens on. Beyond this machine, as at 0.0.0.0, the page asks for
    the token in the printed address, and the traffic is not encrypted."""
    name: str = ""
    """Host name under which browsers reach the page through a proxy, as rig.example."""

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        within("port", self.port, 0, 65535)
        for name, word in (("host", self.host), ("name", self.name or "none")):
            if not word or not is_host(word):
                raise ValueError(f"{name} must be a plain name or address, got {word!r}")


class BusSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where the processes connect."""

    endpoint: str = "tcp/127.0.0.1:7447"
    """The integrator's host listens there, all others connect. Name another host's address to
    spread a rig over hosts, with `keys`; without it nothing outside this machine is accepted.
    "auto": a live run takes a free port of this machine and prints it."""
    session: str = ""
    """A word that all processes of a run add to each message; messages without it are dropped. A
    live run makes one up; "": every message in the room is accepted."""
    keys: str = ""
    """A folder that `tritrack keys` made: all processes speak TLS, show their certificates and
    have the rights of these; the endpoint is then tls/HOST:PORT."""
    open_to_all: bool = False
    """True: accept every connection without keys, even from other machines."""

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        if len(self.session) > MOST_SESSION or not self.session.isascii():
            raise ValueError(
                f"session must be at most {MOST_SESSION} ASCII letters, got {self.session!r}"
            )
        if self.endpoint != AUTO and not is_endpoint(self.endpoint):
            raise SettingsError(
                f"endpoint must look like tcp/127.0.0.1:7447, or be auto, got {self.endpoint!r}"
            )
        if self.endpoint != AUTO and self.endpoint.startswith("tls/") != bool(self.keys):
            raise SettingsError(
                f"keys go with an endpoint tls/HOST:PORT, it with keys (tritrack keys FOLDER): "
                f"got endpoint {self.endpoint!r}, keys {self.keys!r}"
            )
        if is_exposed(self.endpoint) and not self.keys and not self.open_to_all:
            raise SettingsError(
                f"whoever reaches {self.endpoint} could hear and forge all of the run: make keys "
                "(tritrack keys FOLDER) and set keys = 'FOLDER' and the endpoint tls/HOST:PORT, "
                "or set open_to_all = true"
            )
