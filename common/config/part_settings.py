"""The settings of each part of a run: camera, silhouette, search, body, recogniser, page, bus."""

import math
from typing import Final

import msgspec

from common.endpoint import is_endpoint, is_exposed, is_host

MOST_SESSION: Final = 64
"""Letters of a session's word, which goes with every message."""

PAPER_HZ: Final = 15.0
"""Frames a second that settings in frames spoke of (P1)."""
AUTO: Final = "auto"
"""An endpoint that is left open."""


class SettingsError(ValueError):
    """Settings that no run could mean: the text names the file, the place and the cure."""


def within(name: str, value: float, low: float, high: float) -> None:
    """Refuse a number out of bounds.

    Raises:
        ValueError: It names what was got.
    """
    if not low <= value <= high:
        raise ValueError(f"{name} must be from {low} to {high}, got {value}")


class CameraSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where one view's frames come from."""

    source: str = ""
    """A video file; environment variables are filled in."""
    device: int = -1
    """Number of a camera of this host; -1: none."""
    background: str = ""
    """A picture of the empty room, or a video of it."""
    calibrated_as: str = ""
    """Name of the camera in the calibration; by its place in the file when empty."""

    def __post_init__(self) -> None:
        """Refuse a view with two sources."""
        if self.source and self.device >= 0:
            raise ValueError(f"source and device are both set: {self.source}, {self.device}")


class SilhouetteSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How a person is told from the room (P3)."""

    empty_s: float = 0.5
    """For how long a clip shows the empty room at first; if a person stands there already, the
    background is estimated from the whole clip instead."""
    empty_frames: int = 0
    """What settings said before there was `empty_s`: so many frames, of 15 a second."""
    min_height_share: float = 0.15
    """A region lower than this share of the picture is no person."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        within("empty_frames", self.empty_frames, 0, 1000)
        if self.empty_frames:
            msgspec.structs.force_setattr(self, "empty_s", self.empty_frames / PAPER_HZ)
            msgspec.structs.force_setattr(self, "empty_frames", 0)
        within("empty_s", self.empty_s, 0.01, 100.0)
        within("min_height_share", self.min_height_share, 0.01, 1.0)


class SearchSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The overlapped tritree's widths (P41), degrees."""

    arm_window_deg: int = 64
    leg_window_deg: int = 32
    stop_deg: int = 4

    def __post_init__(self) -> None:
        """Widths that halve down to the stop on whole degrees keep the grid exact (P36)."""
        for name in ("arm_window_deg", "leg_window_deg"):
            ratio = getattr(self, name) / self.stop_deg if self.stop_deg > 0 else 0.0
            if ratio < 2 or math.log2(ratio) % 1:
                raise ValueError(
                    f"{name} must be stop_deg times 2, 4, 8 ..., got {getattr(self, name)}"
                )


class BodySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is assumed of the person until measured."""

    stature_m: float = 1.75
    """Assumed where no calibration gives the scale, and of a body before it is measured."""
    opening_frames: int = 3
    """How many accepted frames of the opening posture make the BDPs (their median)."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        within("stature_m", self.stature_m, 0.5, 2.6)
        within("opening_frames", self.opening_frames, 1, 100)


class RecognizerSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How postures are named."""

    model: str = ""
    """A file that `tritrack train` wrote; the one in the package when empty."""
    window_frames: int = 40
    """The stretch of motion that is judged at each frame (section 5: about 40), of 15 a second,
    which is the recogniser's own rate whatever the camera's is."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        within("window_frames", self.window_frames, 5, 600)


class PageSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The live page."""

    port: int = 8080
    """0: no page."""
    wait: bool = True
    """A recorded clip begins when the page is opened, or half a minute later."""
    save_lost: bool = False
    """The last 15 s become a run folder whenever a person who was followed is lost from sight."""
    host: str = "127.0.0.1"
    """Where it listens. Beyond this machine, as at 0.0.0.0, a token in the printed address is asked
    for, and nothing hides what is sent."""
    name: str = ""
    """By which browsers call a proxy that stands before the page, as rig.example."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        within("port", self.port, 0, 65535)
        for name, word in (("host", self.host), ("name", self.name or "none")):
            if not word or not is_host(word):
                raise ValueError(f"{name} must be a plain name or address, got {word!r}")


class BusSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where the processes meet."""

    endpoint: str = "tcp/127.0.0.1:7447"
    """The integrator's host listens there, all others connect to it. Name another host's address
    to spread a rig over hosts, with `keys`; nothing outside this machine is heard otherwise.
    "auto": a live run takes a free port of this machine, and tells it."""
    session: str = ""
    """A word that all processes of a run say with each message: what comes without it is dropped.
    A live run makes one up; "": whoever speaks in the room is heard."""
    keys: str = ""
    """A folder that `tritrack keys` made: all speak TLS, show their certificates, and say no more
    than theirs allows; the endpoint is then tls/HOST:PORT."""
    open_to_all: bool = False
    """Let whoever reaches the endpoint hear and say all, though other machines do."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
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
