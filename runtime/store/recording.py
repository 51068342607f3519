"""`recording.mcap`: a run's reports and results, for a replay.

One MCAP file, readable by any MCAP library: our messages as MessagePack, as sent over the bus
(topics `/report/1`, `/body` ...), each body once more for Foxglove (`/scene`, `/numbers`), and as
metadata settings, rig, body and versions. It holds silhouettes and joints, no picture.
"""

import struct
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any, Final, NamedTuple

import msgspec

from common.atomic_file import replacing
from common.body.body import Bdp
from common.bus.control_messages import Cameras
from common.bus.false_messages import MalformedMessage
from common.bus.message_codec import encode
from common.bus.messages import (
    MOST_VIEWS,
    PROTOCOL,
    Body,
    Message,
    Moment,
    Posture,
    ScaleSource,
    View,
)
from common.config.settings import Settings
from common.rig.camera import Rig
from integrator.frame_numbers import FrameTimes
from runtime.store import foxglove_scene
from runtime.store.older_messages import read_head, read_message
from runtime.store.runs import RunError, unwritable, versions

NAME: Final = "recording.mcap"
TORN: Final = ".recording.*.mcap"
"""Pattern of the names of incomplete recordings in the folder of a run that was killed."""
CHUNK_BYTES: Final = 1 << 17
"""Bytes written at once, half a second to two of a run: at most that is lost when it is killed."""
KINDS: Final[dict[str, type[Message]]] = {
    **{f"/report/{number}": View for number in range(1, MOST_VIEWS + 1)},
    "/body": Body,
    "/posture": Posture,
    "/cameras": Cameras,
}
"""Topics of our own messages."""

Keep = Callable[[Message], None]


class RecordingError(ValueError):
    """A recording that cannot be written or read: the text names it and the cure."""


class Head(msgspec.Struct, frozen=True, kw_only=True):
    """What an integrator must know before the first report."""

    name: str
    settings: Settings
    period_s: float
    alone: bool
    """The run has a single viewer."""
    rig: Rig | None
    """None: it is assumed when a person is seen."""
    scale_source: ScaleSource | None = None
    """Source of the rig; None: it is calibrated, if there is one."""
    by_person: bool = False
    """The rig comes from the person during the run."""
    body: Bdp | None
    """As measured before the run; None: it was not measured."""
    times: FrameTimes | None = None
    """When camera 1 takes its frames; None where it is no part of the run."""
    cameras: tuple[str, ...] = ()
    """Names of the rig's cameras."""
    protocol: int = PROTOCOL
    versions: dict[str, str] = {}


class Recording(NamedTuple):
    """The content of a recording, each kind in order."""

    head: Head
    reports: tuple[list[View], ...]
    """For each viewer of the rig, in their order."""
    bodies: list[Body]
    postures: list[Posture]
    cameras: list[Cameras]


@contextmanager
def recording_to(folder: Path, head: Head) -> Iterator[Keep]:
    """A function that records a message; the file is written as it grows and gets its name at the
    end.

    Raises:
        RecordingError: Without the library mcap.
        RunError: When the file cannot be written: it is removed then, to leave room for the
        results.
    """
    library = _library()
    with ExitStack() as doors:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path = doors.enter_context(replacing(folder / NAME))
            file = doors.enter_context(path.open("wb"))
        except OSError as error:
            raise unwritable(folder, error) from error
        writer = library.Writer(file, chunk_size=CHUNK_BYTES)
        writer.start(profile="", library="tritrack")
        told = msgspec.structs.replace(head, versions=versions())
        writer.add_metadata("tritrack", {"head": msgspec.json.encode(told).decode()})
        yield _keeper(writer, file)
        try:
            writer.finish()
            doors.close()
        except OSError as error:
            with suppress(OSError):  # the disk could not take the rest, and cannot now
                file.close()
            raise RunError(
                f"{folder / NAME} could not be written to its end ({error.strerror}) and is gone, "
                "so that there is room for what was measured: free some space, and record again"
            ) from error


def read_recording(folder: Path) -> Recording:
    """Read the recording of a run folder; for a run that was killed, its incomplete one.

    Raises:
        RecordingError: When there is none, or it is damaged, or of another version.
    """
    library = _library()
    if not folder.is_dir():
        raise RecordingError(f"there is no run folder {folder}: name one made with --record")
    whole = folder / NAME
    path = whole if whole.is_file() else next(iter(torn_recordings(folder)), None)
    if path is None:
        raise RecordingError(
            f"{folder} has no {NAME}: track or run live again with --record, then replay it"
        )
    found: dict[str, list[Any]] = {topic: [] for topic in KINDS}
    heads: list[Head] = []
    try:
        with path.open("rb") as file, suppress(*(() if path is whole else library.errors)):
            for said in _said(library.StreamReader(file, validate_crcs=True)):
                if isinstance(said, Head):
                    heads.append(said)
                else:
                    found[topic_of(said)].append(said)
    except library.errors as error:
        raise RecordingError(
            f"{path} was damaged or is of another version ({str(error) or type(error).__name__}): "
            "record again"
        ) from error
    if not heads:
        raise RecordingError(f"{path} was damaged, or ended before it began: record again")
    reports = tuple(found[topic] for topic, kind in KINDS.items() if kind is View)
    return Recording(heads[0], reports, found["/body"], found["/posture"], found["/cameras"])


def torn_recordings(folder: Path) -> list[Path]:
    """Incomplete recordings in a folder, of runs that were killed, the newest first."""
    return sorted(folder.glob(TORN), key=lambda path: path.stat().st_mtime_ns, reverse=True)


def _said(reader: Any) -> Iterator[Head | Message]:
    """Our messages in a recording, in order."""
    topics: dict[int, str] = {}
    for record in reader.records:
        match type(record).__name__:
            case "Channel":
                topics[record.id] = record.topic
            case "Metadata":
                yield read_head(msgspec.json.decode(record.metadata["head"]), Head)
            case "Message" if topics[record.channel_id] in KINDS:
                yield read_message(record.data, KINDS[topics[record.channel_id]])


def _keeper(writer: Any, file: IO[bytes]) -> Keep:
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
        file.flush()  # nothing, except where a chunk is full

    return keep


def topic_of(message: Message) -> str:
    """Place of a message in a recording."""
    if isinstance(message, View):
        return f"/report/{message.viewer}"
    return f"/{type(message).__name__.lower()}"


class _Library(NamedTuple):
    Writer: Any
    StreamReader: Any
    errors: tuple[type[Exception], ...]
    """Exceptions of reading a damaged file."""


def _library() -> _Library:
    try:
        from mcap.exceptions import McapError
        from mcap.stream_reader import StreamReader
        from mcap.writer import Writer
        from zstandard import ZstdError
    except ImportError as error:
        raise RecordingError("recordings need mcap: pip install 'tritrack[mcap]'") from error
    own = (McapError, ZstdError, MalformedMessage, struct.error)
    errors = (*own, OSError, ValueError, KeyError, RuntimeError, OverflowError, MemoryError)
    return _Library(Writer, StreamReader, errors)


def refuse_without_library() -> None:
    """Check before a run that it can be recorded.

    Raises:
        RecordingError: Without the library mcap.
    """
    _library()
