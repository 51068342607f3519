"""The bus within one process: every message is encoded and decoded as between processes."""

from collections.abc import Callable
from typing import Any

from common.bus.inbox import BOUND, QUESTIONS, Alive, Inbox, answered, checked
from common.bus.mailbox import Mailbox
from common.bus.message_codec import Said, encode, key_of
from common.bus.messages import Message


class LocalBus:
    """A room around one object; see Bus for what each method promises."""

    def __init__(self, room: str = "room") -> None:
        """An empty room."""
        self._room = room
        self._inboxes: dict[type[Message], list[Inbox[Any]]] = {}
        self._newest: dict[type[Message], bytes] = {}
        self._kept: set[type[Message]] = set()
        self._answers: dict[str, Callable[[bytes], Message | None]] = {}
        self._alive: list[Alive] = []
        self._watchers: list[Mailbox[Alive]] = []

    def publish(self, message: Message) -> None:
        """Say a message; see Bus."""
        kind, payload = type(message), encode(message)
        if kind in self._kept:
            self._newest[kind] = payload
        for inbox in self._inboxes.get(kind, []):
            inbox.offer(key_of(message, self._room), payload)

    def subscribe(self, kind: type[Said]) -> Inbox[Said]:
        """Hear a kind of message; see Bus."""
        inbox = Inbox(kind, self._room)
        self._inboxes.setdefault(kind, []).append(inbox)
        return inbox

    def keep(self, kind: type[Message]) -> None:
        """Hold the newest message of a kind; see Bus."""
        self._kept.add(kind)

    def latest(self, kind: type[Said], timeout_s: float) -> Said | None:
        """The newest message of a kind; see Bus. The answer is there at once or never."""
        payload = self._newest.get(kind)
        return None if payload is None else checked(payload, kind, kind.__name__)

    def answer(self, kind: type[Said], reply: Callable[[Said], Message]) -> None:
        """Answer a kind of question; see Bus."""
        key = QUESTIONS[kind]
        self._answers[key] = lambda payload: answered(reply, kind, payload, key)

    def ask(self, question: Message, kind: type[Said], timeout_s: float) -> Said | None:
        """The answer to a question; see Bus. It is there at once or never."""
        key = QUESTIONS[type(question)]
        reply = self._answers[key](encode(question)) if key in self._answers else None
        return None if reply is None else checked(encode(reply), kind, key)

    def announce(self, name: str) -> None:
        """Let others know that this process lives; see Bus."""
        self._alive.append(Alive(name, alive=True))
        for watcher in self._watchers:
            watcher.put(self._alive[-1])

    def watch_alive(self) -> Mailbox[Alive]:
        """Hear who comes; nobody goes before the room does."""
        watcher: Mailbox[Alive] = Mailbox(BOUND)
        for alive in self._alive:
            watcher.put(alive)
        self._watchers.append(watcher)
        return watcher
