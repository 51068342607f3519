"""Received messages: checked on arrival, bounded, counted."""

import logging
from collections.abc import Callable
from typing import Final, Generic, NamedTuple

from common.bus.control_messages import ClockQuestion
from common.bus.false_messages import MalformedMessage
from common.bus.mailbox import Mailbox
from common.bus.message_codec import TOPICS, Said, decode, key_of, pattern_of
from common.bus.messages import Message
from common.config.part_settings import MOST_SESSION

QUESTIONS: Final[dict[type[Message], str]] = {ClockQuestion: "tritrack/{room}/clock"}
"""The key on which each kind of question is answered."""

BOUND: Final = 256
"""Messages that may wait for a reader: eight seconds of two viewers at 15 Hz; older ones are of
no use."""

MOST_GAP: Final = 100_000
"""Messages that a link may lose in one gap: two hours of them. A larger gap means another
sender."""

log = logging.getLogger(__name__)


class Alive(NamedTuple):
    """A process came (it announced itself) or went (it closed, died or fell silent)."""

    name: str
    alive: bool


class Inbox(Generic[Said]):
    """Received messages of one kind, oldest first; where only the newest counts, one per key."""

    def __init__(self, kind: type[Said], room: str) -> None:
        """An empty inbox for one kind of message in one site."""
        self.malformed = 0
        """Number of payloads that were refused."""
        self.foreign = 0
        """Number of messages of other runs."""
        self._kind = kind
        self._room = room
        self._missed = 0
        self._numbers: dict[str, int] = {}
        self._mailbox: Mailbox[Said] = Mailbox(BOUND)

    @property
    def dropped(self) -> int:
        """Number of messages lost, here or on the way, of a kind of which each one counts."""
        return self._mailbox.dropped + self._missed

    def take(self, timeout_s: float) -> Said | None:
        """The oldest message; None when none came in time, or the bus is closed."""
        return self._mailbox.take(timeout_s)

    def drain(self) -> list[Said]:
        """All messages that wait, oldest first."""
        return self._mailbox.drain()

    def close(self) -> None:
        """Stop receiving."""
        self._mailbox.close()

    def offer(self, key: str, payload: bytes) -> None:
        """Accept the payload received on a key; a malformed one is counted, and the first is
        logged."""
        try:
            message = decode(payload, self._kind)
            if key_of(message, self._room) != key:
                raise MalformedMessage(f"it belongs on {key_of(message, self._room)}")
        except MalformedMessage as error:
            self.refuse(key, error)
            return
        self._mailbox.put(message, slot=key if TOPICS[self._kind].newest_only else None)

    def count(self, key: str, number: int) -> None:
        """Note the sequence number of a message on its key: missing numbers were lost on the way.

        A number below the last one means that the sender was restarted.
        """
        if key not in self._numbers and len(self._numbers) == BOUND:
            return
        gap = number - self._numbers.get(key, number) - 1
        if not TOPICS[self._kind].newest_only and 0 < gap <= MOST_GAP:
            self._missed += gap
        self._numbers[key] = number

    def refuse_foreign(self, key: str, word: bytes) -> None:
        """Count a message on a key that belongs to another run or to none; the first is logged."""
        self.foreign += 1
        if self.foreign == 1:
            whose = repr(word[:MOST_SESSION]) if word else "none"
            log.warning("%s: dropped a message of another session: %s", key, whose)

    def refuse(self, key: str, why: MalformedMessage) -> None:
        """Count a malformed payload on a key; the first is logged."""
        self.malformed += 1
        if self.malformed == 1:
            pattern = pattern_of(self._kind, self._room)
            log.warning("%s: dropped a message from %s: %s", pattern, key, why)


def checked(payload: bytes, kind: type[Said], where: str) -> Said | None:
    """A question or answer that passed the checks; None after a line in the log."""
    try:
        return decode(payload, kind)
    except MalformedMessage as error:
        log.warning("%s: dropped what came: %s", where, error)
        return None


def answered(
    reply: Callable[[Said], Message], kind: type[Said], payload: bytes, where: str
) -> Message | None:
    """The payload with which `reply` answers a question; None when either fails, which is logged.

    The bus's threads swallow exceptions, so a failing `reply` is caught and logged here.
    """
    question = checked(payload, kind, where)
    if question is None:
        return None
    try:
        return reply(question)
    except Exception:
        log.exception("%s: no answer to %s", where, question)
        return None
