"""The published schema: that of the types, and live messages of every topic fit it."""

import base64
import json
import threading
from pathlib import Path
from typing import Any

import jsonschema
import msgpack
import pytest
import zenoh
from message_schema import schema, text
from rich.console import Console
from test_message_codec import SAID

from common.bus.message_codec import TOPICS, encode
from common.bus.messages import Message
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from runtime.live.free_ports import free_settings
from runtime.live.session import live

DOCS = Path(__file__).parents[1] / "docs" / "messages.schema.json"


def plain(value: Any) -> Any:
    """What a reader of MessagePack has, as JSON writes it: bytes are base64."""
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    return [plain(each) for each in value] if isinstance(value, list) else value


def check(payload: bytes, kind: type[Message]) -> None:
    whole = schema()
    own = {**whole["topics"][kind.__name__]["schema"], "$defs": whole["$defs"]}
    jsonschema.Draft202012Validator(own).validate(plain(msgpack.unpackb(payload)))


def test_what_is_published_is_written_from_the_types() -> None:
    """Else: .venv/bin/python benchmarks/message_schema.py."""
    assert DOCS.read_text() == text()
    jsonschema.Draft202012Validator.check_schema(json.loads(text()))


@pytest.mark.parametrize("message", SAID, ids=lambda each: type(each).__name__)
def test_a_full_message_of_each_kind_fits(message: Message) -> None:
    if type(message) in TOPICS:
        check(encode(message), type(message))


def test_what_no_process_says_does_not_fit() -> None:
    message = next(each for each in SAID if type(each).__name__ == "View")
    spoilt = msgpack.unpackb(encode(message)) | {"viewer": 9}
    with pytest.raises(jsonschema.ValidationError):
        check(msgpack.packb(spoilt), type(message))


def listen(endpoint: str, heard: list[tuple[str, bytes]], over: threading.Event) -> None:
    """All that is said in the room, from when its hub answers until the test is over.

    Once a body is heard, the stranger knows the run's own word, which goes behind the number of all
    that it says. With it the stranger asks for what was said before it came, which the hub keeps
    for whoever comes late, and asks the run to save what it saw; the run answers.
    """
    words: list[bytes] = []

    def hear(sample: zenoh.Sample) -> None:
        heard.append((str(sample.key_expr), sample.payload.to_bytes()))
        if str(sample.key_expr).endswith("/body/pose") and sample.attachment is not None:
            words.append(sample.attachment.to_bytes()[8:])

    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    while not over.wait(0.1):
        try:
            session = zenoh.open(config)
        except zenoh.ZError:
            continue
        with session:
            session.declare_subscriber("tritrack/room/**", hear)
            while not words and not over.wait(0.1):
                pass
            word = b"".join(words[:1])
            for reply in session.get("tritrack/room/**", timeout=2.0, attachment=word):
                if reply.ok is not None:
                    hear(reply.ok)
            ours = (1).to_bytes(8, "big") + word
            session.put("tritrack/room/command", msgpack.packb({"what": "save"}), attachment=ours)
            over.wait()


@pytest.mark.slow
@pytest.mark.live
def test_live_messages_of_every_topic_fit(clip: Path, tmp_path: Path) -> None:
    """Heard by Zenoh alone, as a stranger's program does."""
    settings = free_settings(Settings(clip=str(clip), pictures=True, page=PageSettings(port=0)))
    heard: list[tuple[str, bytes]] = []
    over = threading.Event()
    listener = threading.Thread(target=listen, args=(settings.bus.endpoint, heard, over))
    listener.start()
    try:
        live(settings, tmp_path, Console(quiet=True))
    finally:
        over.set()
        listener.join()
    met = set()
    for key, payload in heard:
        for kind, topic in TOPICS.items():
            if zenoh.KeyExpr(topic.key.format(room="room", viewer="*", process="*")).intersects(
                zenoh.KeyExpr(key)
            ):
                check(payload, kind)
                met.add(kind)
    assert met == set(TOPICS)
    assert list((tmp_path / "saved").iterdir()), "what the stranger asked for was done"
