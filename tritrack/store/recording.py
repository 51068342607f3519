"""`recording.mcap`: all that a run's viewers reported and what was made of it, to do it again.

One MCAP file, readable by any MCAP library: our messages as MessagePack, as they went over the bus
(topics `/report/1`, `/body` ...), each body once more for Foxglove (`/scene`, `/numbers`), and as
metadata settings, rig, body and versions. Outlines and joints, no picture.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from common.atomic_file import replacing
from common.body.body import Bdp
from common.bus.control_messages import Cameras
from common.bus.message_codec import MalformedMessage, decode, encode
from common.bus.messages import PROTOCOL, Body, Message, Moment, Posture, Report, ScaleSource
from common.config.settings import Settings
from common.rig.camera import Rig
from integrator.frame_numbers import FrameTimes
from tritrack.store import foxglove_scene
from tritrack.store.runs import unwritable, versions

NAME: Final = "recording.mcap"
KINDS: Final[dict[str, type[Message]]] = {
    "/report/1": Report,
    "/report/2": Report,
    "/body": Body,
    "/posture": Posture,
    "/cameras": Cameras,
}
"""Topics of our own messages."""

Keep = Callable[[Message], None]


class RecordingError(ValueError):
    """A recording that cannot be written or read: the text names it and the cure."""


class Head(msgspec.Struct, frozen=True, kw_only=True):
    """What an integrator has to know before the first report."""

    name: str
    settings: Settings
    period_s: float
    alone: bool
    """One viewer is all that the run has."""
    rig: Rig | None
    """None: it is assumed when somebody is seen."""
    scale_source: ScaleSource | None = None
    """Where the rig is from; None: it is calibrated, if there is one."""
    by_person: bool = False
    """The person tells the rig while the run goes on."""
    body: Bdp | None
    """As measured before the run; None: it was not."""
    times: FrameTimes | None = None
    """When camera 1 takes its frames; None where it is no part of the run."""
    protocol: int = PROTOCOL
    versions: dict[str, str] = {}


class Recording(NamedTuple):
    """What a recording holds, each in the order in which it was said."""

    head: Head
    reports: tuple[list[Report], list[Report]]
    """Of viewer 1 and of viewer 2."""
    bodies: list[Body]
    postures: list[Posture]
    cameras: list[Cameras]


@contextmanager
def recording_to(folder: Path, head: Head) -> Iterator[Keep]:
    """A function that keeps a message; the file is there when all is said.

    Raises:
        RecordingError: Without the library mcap.
        RunError: When the file cannot be written.
    """
    library = _library()
    with ExitStack() as doors:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path = doors.enter_context(replacing(folder / NAME))
            file = doors.enter_context(path.open("wb"))
        except OSError as error:
            raise unwritable(folder, error) from error
        writer = library.Writer(file)
        writer.start(profile="", library="tritrack")
        told = msgspec.structs.replace(head, versions=versions())
        writer.add_metadata("tritrack", {"head": msgspec.json.encode(told).decode()})
        yield _keeper(writer)
        writer.finish()


def read_recording(folder: Path) -> Recording:
    """Read the recording of a run folder.

    Raises:
        RecordingError: When there is none, or it was damaged, or another version wrote it.
    """
    library = _library()
    path = folder / NAME
    if not folder.is_dir():
        raise RecordingError(f"there is no run folder {folder}: name one made with --record")
    if not path.is_file():
        raise RecordingError(
            f"{folder} has no {NAME}: track or run live again with --record, then replay it"
        )
    found: dict[str, list[Any]] = {topic: [] for topic in KINDS}
    try:
        with path.open("rb") as file:
            reader = library.NonSeekingReader(file)
            for _schema, channel, message in reader.iter_messages([*KINDS], log_time_order=False):
                found[channel.topic].append(decode(message.data, KINDS[channel.topic]))
        with path.open("rb") as file:
            (told,) = library.make_reader(file).iter_metadata()
        head = msgspec.json.decode(told.metadata["head"], type=Head)
    except library.errors as error:
        raise RecordingError(
            f"{path} was damaged or is of another version ({error}): record again"
        ) from error
    reports = (found["/report/1"], found["/report/2"])
    return Recording(head, reports, found["/body"], found["/posture"], found["/cameras"])


def _keeper(writer: Any) -> Keep:
    named = {
        name: writer.register_schema(name, "jsonschema", schema)
        for name, schema in foxglove_scene.schemas().items()
    }
    scene = writer.register_channel("/scene", "json", named[foxglove_scene.SCENE])
    numbers = writer.register_channel("/numbers", "json", named[foxglove_scene.NUMBERS])
    own = {topic: writer.register_channel(topic, "msgpack", 0) for topic in KINDS}
    last_ns = 0

    def keep(message: Message) -> None:
        nonlocal last_ns
        if isinstance(message, Moment):
            last_ns = max(0, round(1e9 * message.captured_s))

        def add(channel: int, data: bytes) -> None:
            writer.add_message(channel, log_time=last_ns, publish_time=last_ns, data=data)

        add(own[topic_of(message)], encode(message))
        if isinstance(message, Body):
            add(scene, foxglove_scene.scene_of(message))
            add(numbers, foxglove_scene.numbers_of(message))

    return keep


def topic_of(message: Message) -> str:
    """Where a recording has a message."""
    if isinstance(message, Report):
        return f"/report/{message.viewer}"
    return f"/{type(message).__name__.lower()}"


class _Library(NamedTuple):
    Writer: Any
    NonSeekingReader: Any
    make_reader: Any
    errors: tuple[type[Exception], ...]
    """What reading raises of a damaged file."""


def _library() -> _Library:
    try:
        from mcap.exceptions import McapError
        from mcap.reader import NonSeekingReader, make_reader
        from mcap.writer import Writer
        from zstandard import ZstdError
    except ImportError as error:
        raise RecordingError("recordings need mcap: pip install 'tritrack[mcap]'") from error
    own = (McapError, ZstdError, MalformedMessage)
    errors = (*own, OSError, ValueError, KeyError, RuntimeError, OverflowError, MemoryError)
    return _Library(Writer, NonSeekingReader, make_reader, errors)


def refuse_without_library() -> None:
    """Say before a run that it cannot be recorded.

    Raises:
        RecordingError: Without the library mcap.
    """
    _library()
