"""The settings: one frozen value with defaults; a TOML file only departs from them."""

import math
import os
from pathlib import Path
from typing import Final

import msgspec

from common.endpoint import is_exposed
from common.method import Mode

MOST_SESSION: Final = 64
"""Letters of a session's word, which goes with every message."""

AUTO: Final = "auto"
"""An endpoint that is left open."""

LANDMARK_SOURCES: Final = ("own", "none", "mediapipe")
"""What `landmarks` may say instead of a folder."""


class SettingsError(ValueError):
    """Settings that no run could mean: the text names the file, the place and the cure."""


def _within(name: str, value: float, low: float, high: float) -> None:
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
    """Its name in the calibration; by its place in the file when empty."""

    def __post_init__(self) -> None:
        """Refuse a view with two sources."""
        if self.source and self.device >= 0:
            raise ValueError(f"source and device are both set: {self.source}, {self.device}")


class SilhouetteSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How a person is told from the room (P3)."""

    empty_frames: int = 8
    """How many opening frames show the empty room in a clip; if somebody stands there already,
    the background is estimated from the whole clip instead."""
    min_height_share: float = 0.15
    """A region lower than this share of the picture is nobody."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        _within("empty_frames", self.empty_frames, 1, 1000)
        _within("min_height_share", self.min_height_share, 0.01, 1.0)


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
        _within("stature_m", self.stature_m, 0.5, 2.6)
        _within("opening_frames", self.opening_frames, 1, 100)


class RecognizerSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How postures are named."""

    model: str = ""
    """A file that `tritrack train` wrote; the one in the package when empty."""
    window_frames: int = 40
    """The stretch of motion that is judged at each frame (section 5: about 40)."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        _within("window_frames", self.window_frames, 5, 600)


class PageSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The live page."""

    port: int = 8080
    """0: no page."""
    wait: bool = True
    """A recorded clip begins when somebody looks at the page, or half a minute later."""
    host: str = "127.0.0.1"
    """Where it listens. Beyond this machine, as at 0.0.0.0, a token in the printed address is asked
    for, and nothing hides what is sent."""
    name: str = ""
    """By which browsers call a proxy that stands before the page, as rig.example."""

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        _within("port", self.port, 0, 65535)
        for name, word in (("host", self.host), ("name", self.name or "none")):
            if not word or set(word) & set("/@?# "):
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
    nothing ("none"), "mediapipe", or a folder of keypoint files."""
    every: int = 1
    """Take every n-th frame of a recorded clip."""
    fps: float = 0.0
    """Rate at which recorded clips are taken to run, and played; 0: what they say themselves. Of
    cameras on another host than the integrator's: theirs."""
    metrics: str = ""
    """HOST:PORT at which a live run answers /metrics (Prometheus) and /healthz; nowhere when
    empty."""
    pictures: bool = False
    """Publish small pictures for the page; otherwise no picture leaves a viewer."""
    camera_1: CameraSettings | None = None
    camera_2: CameraSettings | None = None
    silhouette: SilhouetteSettings = SilhouetteSettings()
    search: SearchSettings = SearchSettings()
    body: BodySettings = BodySettings()
    recognizer: RecognizerSettings = RecognizerSettings()
    page: PageSettings = PageSettings()
    bus: BusSettings = BusSettings()

    def __post_init__(self) -> None:
        """Refuse what no run could mean."""
        if not self.room or set(self.room) & set("/*$#? "):
            raise ValueError(f"room must be a plain word, got {self.room!r}")
        size_of(self.size)
        if not self.landmarks:
            raise ValueError(f"landmarks must be {', '.join(LANDMARK_SOURCES)} or a folder")
        _within("every", self.every, 1, 1000)
        _within("fps", self.fps, 0.0, 1000.0)
        if self.metrics:
            address_of(self.metrics)


def load(path: Path) -> Settings:
    """Read a settings file, or take a clip folder as one with nothing else set.

    Relative paths in the file are relative to the file.

    Raises:
        SettingsError: When it cannot be read, holds an unknown or ill-typed setting, or its
            landmarks name no folder.
    """
    if path.is_dir():
        return Settings(clip=str(path))
    if not path.exists():
        raise SettingsError(f"there is no clip folder and no settings file {path}: check the path")
    try:
        text = path.read_bytes()
    except OSError as error:
        raise SettingsError(f"cannot read the settings {path}: {error.strerror}") from error
    try:
        settings = msgspec.toml.decode(text, type=Settings)
    except UnicodeDecodeError as error:
        raise SettingsError(
            f"{path} is no settings file: name a TOML file, or a clip folder"
        ) from error
    except msgspec.DecodeError as error:
        raise SettingsError(f"{path}: {error}") from error
    return with_full_paths(settings, path)


def size_of(text: str) -> tuple[int, int]:
    """A picture size as it is written, `160x120`.

    Raises:
        ValueError: When it is no size, or none between 32x32 and 4096x4096.
    """
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise ValueError(f"size must look like 160x120, got {text!r}")
    _within("width", int(width), 32, 4096)
    _within("height", int(height), 32, 4096)
    return int(width), int(height)


def address_of(text: str) -> tuple[str, int]:
    """Host and port of an address as it is written, `127.0.0.1:9464`.

    Raises:
        ValueError: When it is none.
    """
    host, _, port = text.rpartition(":")
    if not (host and port.isdecimal() and 0 < int(port) < 65536):
        raise ValueError(f"metrics must look like 127.0.0.1:9464, got {text!r}")
    return host, int(port)


def working_size(source: tuple[int, int], bound: tuple[int, int]) -> tuple[int, int]:
    """Largest size of the source's shape within the bound; never larger than the source."""
    shrink = min(1.0, bound[0] / source[0], bound[1] / source[1])
    return max(1, round(source[0] * shrink)), max(1, round(source[1] * shrink))


def with_full_paths(settings: Settings, path: Path) -> Settings:
    """Settings that stand in a file: relative paths from there, environment variables filled in.

    Raises:
        SettingsError: When a variable is not set, or the landmarks name no folder.
    """
    folder = path.parent

    def full(name: str) -> str:
        filled = os.path.expandvars(name)
        if "$" in filled:
            raise SettingsError(f"{path}: {name} names a variable that is not set: export it")
        return str(folder / filled) if name else ""

    def camera(given: CameraSettings | None) -> CameraSettings | None:
        if given is None:
            return None
        return msgspec.structs.replace(
            given, source=full(given.source), background=full(given.background)
        )

    def landmarks(given: str) -> str:
        if given in LANDMARK_SOURCES:
            return given
        if not Path(full(given)).is_dir():
            known = ", ".join(LANDMARK_SOURCES)
            raise SettingsError(
                f"{path}: there is no folder {full(given)} of landmarks: write its path, or {known}"
            )
        return full(given)

    return msgspec.structs.replace(
        settings,
        landmarks=landmarks(settings.landmarks),
        clip=full(settings.clip),
        calibration=full(settings.calibration),
        opening=full(settings.opening),
        camera_1=camera(settings.camera_1),
        camera_2=camera(settings.camera_2),
        recognizer=msgspec.structs.replace(
            settings.recognizer, model=full(settings.recognizer.model)
        ),
        bus=msgspec.structs.replace(settings.bus, keys=full(settings.bus.keys)),
    )
