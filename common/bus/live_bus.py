"""The messages of a site over a Zenoh session."""

import logging
import threading
from collections import Counter
from collections.abc import Callable
from typing import Any, Final

import zenoh

from common.bus.false_messages import MalformedMessage
from common.bus.inbox import BOUND, QUESTIONS, Alive, Inbox, answered, checked
from common.bus.mailbox import Mailbox
from common.bus.message_codec import TOPICS, Said, encode, key_of, pattern_of, refuse_size
from common.bus.messages import Message, Picture
from common.config.part_settings import MOST_SESSION

AT_ONCE: Final = 4
"""Newest-only samples that may wait for our own thread: two viewers publish at the same moment.
Zenoh's default queue would give ever older ones to a slow reader."""

NUMBER_BYTES: Final = 8
"""Key expression that matches a sequence number and the run's word. Every message carries its
number on its key, so that a receiver can count losses: under congestion Zenoh drops without
notice."""

log = logging.getLogger(__name__)


class LiveBus:
    """A Zenoh session in a site; see Bus for each method's contract."""

    def __init__(self, session: Any, room: str, run: str = "") -> None:
        """Publish and receive in `room` over an open session; only messages of the same run
        where it has a word."""
        self._session = session
        self._run = run.encode()
        self._room = room
        self._lock = threading.Lock()
        self._publishers: dict[str, Any] = {}
        self._said: Counter[str] = Counter()
        self._newest: dict[type[Message], dict[str, bytes]] = {}
        self._tokens: list[Any] = []
        self._heard: list[tuple[Any, threading.Thread, Inbox[Any] | Mailbox[Alive]]] = []
        self._queryables: list[Any] = []

    def publish(self, message: Message) -> None:
        """Publish a message; see Bus."""
        key, payload = key_of(message, self._room), encode(message)
        with self._lock:
            if key not in self._publishers:
                self._publishers[key] = self._declare_publisher(key, type(message))
            if type(message) in self._newest:
                self._newest[type(message)][key] = payload
            self._said[key] += 1
            number = self._said[key].to_bytes(NUMBER_BYTES, "big")
        self._publishers[key].put(payload, attachment=number + self._run)

    def subscribe(self, kind: type[Said]) -> Inbox[Said]:
        """Receive a kind of message; see Bus."""
        inbox = Inbox(kind, self._room)
        channel: Any = (
            zenoh.handlers.RingChannel(AT_ONCE)
            if TOPICS[kind].newest_only
            else zenoh.handlers.FifoChannel(BOUND)
        )
        subscriber = self._session.declare_subscriber(pattern_of(kind, self._room), channel)

        def hear(sample: Any) -> None:
            key = str(sample.key_expr)
            said = sample.attachment.to_bytes() if sample.attachment is not None else b""
            if not self._is_ours(said[NUMBER_BYTES:]):
                inbox.refuse_foreign(key, said[NUMBER_BYTES:])
                return
            try:
                refuse_size(len(sample.payload))  # before it is copied: cheapest in a flood
            except MalformedMessage as error:
                inbox.refuse(key, error)
            else:
                inbox.offer(key, sample.payload.to_bytes())
                if len(said) >= NUMBER_BYTES:
                    inbox.count(key, int.from_bytes(said[:NUMBER_BYTES], "big"))

        self._listen(subscriber, hear, inbox)
        return inbox

    def keep(self, kind: type[Message]) -> None:
        """Hold the newest message of a kind; see Bus."""
        with self._lock:
            self._newest.setdefault(kind, {})

        def reply(query: Any) -> None:
            with self._lock:
                kept = dict(self._newest[kind])
            for key, payload in kept.items():
                query.reply(key, payload, attachment=self._run)

        self._serve(pattern_of(kind, self._room), reply)

    def latest(self, kind: type[Said], timeout_s: float) -> Said | None:
        """The newest message of a kind; see Bus."""
        return self._get(pattern_of(kind, self._room), kind, None, timeout_s)

    def answer(self, kind: type[Said], reply: Callable[[Said], Message]) -> None:
        """Answer a kind of question; see Bus."""
        key = QUESTIONS[kind].format(room=self._room)

        def reply_to(query: Any) -> None:
            payload = query.payload.to_bytes() if query.payload else b""
            said = answered(reply, kind, payload, key)
            if said is not None:
                query.reply(key, encode(said), attachment=self._run)

        self._serve(key, reply_to)

    def ask(self, question: Message, kind: type[Said], timeout_s: float) -> Said | None:
        """The answer to a question; see Bus."""
        key = QUESTIONS[type(question)].format(room=self._room)
        return self._get(key, kind, encode(question), timeout_s)

    def announce(self, name: str) -> None:
        """Announce this process; see Bus."""
        key = f"tritrack/{self._room}/alive/{name}"
        self._tokens.append(self._session.liveliness().declare_token(key))

    def watch_alive(self) -> Mailbox[Alive]:
        """Report which processes come and go; see Bus."""
        mailbox: Mailbox[Alive] = Mailbox(BOUND)
        subscriber = self._session.liveliness().declare_subscriber(
            f"tritrack/{self._room}/alive/*", zenoh.handlers.FifoChannel(BOUND), history=True
        )

        def hear(sample: Any) -> None:
            name = str(sample.key_expr).rpartition("/")[2]
            mailbox.put(Alive(name, sample.kind == zenoh.SampleKind.PUT))

        self._listen(subscriber, hear, mailbox)
        return mailbox

    def close(self) -> None:
        """End the threads, then undeclare everything."""
        for subscriber, thread, box in self._heard:
            box.close()
            subscriber.undeclare()
            thread.join()
        for declared in [*self._queryables, *self._tokens, *self._publishers.values()]:
            declared.undeclare()

    def _is_ours(self, word: bytes) -> bool:
        return not self._run or word == self._run

    def _declare_publisher(self, key: str, kind: type[Message]) -> Any:
        return self._session.declare_publisher(
            key,
            congestion_control=zenoh.CongestionControl.DROP,
            express=True,
            priority=zenoh.Priority.DATA_LOW
            if kind is Picture
            else zenoh.Priority.INTERACTIVE_HIGH,
        )

    def _listen(
        self, subscriber: Any, hear: Callable[[Any], None], box: Inbox[Any] | Mailbox[Alive]
    ) -> None:
        """Drain a channel into our own bounded inbox, until the subscriber is undeclared."""

        def drain() -> None:
            for sample in subscriber:
                hear(sample)

        thread = threading.Thread(target=drain, name=f"bus {subscriber.key_expr}", daemon=True)
        thread.start()
        self._heard.append((subscriber, thread, box))

    def _serve(self, key: str, reply: Callable[[Any], None]) -> None:
        def serve(query: Any) -> None:
            with query:
                whose = _word_of(query)
                if not self._is_ours(whose):
                    log.warning("%s: no answer to another session: %r", key, whose[:MOST_SESSION])
                    return
                try:
                    reply(query)
                except zenoh.ZError as error:
                    log.warning("%s: an answer could not be sent: %s", key, error)

        self._queryables.append(self._session.declare_queryable(key, serve))

    def _get(
        self, key: str, kind: type[Said], payload: bytes | None, timeout_s: float
    ) -> Said | None:
        asked = self._session.get(key, payload=payload, timeout=timeout_s, attachment=self._run)
        for reply in asked:
            if reply.ok is not None and self._is_ours(_word_of(reply.ok)):
                said = checked(reply.ok.payload.to_bytes(), kind, key)
                if said is not None:
                    return said
        return None


def _word_of(told: Any) -> bytes:
    """The run's word that travels with a question or its answer."""
    return told.attachment.to_bytes() if told.attachment is not None else b""
