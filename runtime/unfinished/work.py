"""Where a run keeps what it makes while it goes on: in memory, or on disk and to be resumed."""

from typing import Any, NamedTuple, Protocol, TypeVar

from runtime.terminal import Tell
from runtime.unfinished.message_file import MessageFile

State = TypeVar("State")
Kept = list[Any] | MessageFile[Any]
"""Messages in the order in which they came; what comes is appended."""


class Work(Protocol):
    """What a run keeps while it goes on."""

    @property
    def due(self) -> bool:
        """Whether the state is to be saved now."""

    def messages(self, name: str) -> Kept:
        """Messages of one kind, as far as they had come."""

    def resumed(self, stage: str, kind: type[State]) -> State | None:
        """The state in which a stage was left; None where it was not begun, or is over."""

    def save(self, stage: str, state: object) -> None:
        """The state of a stage, for the case that the run is cut short."""

    def restart(self) -> None:
        """The run begins anew: what was kept is forgotten when it is asked for again."""


class InMemory:
    """Nothing outlives the run."""

    due = False

    def messages(self, _name: str) -> Kept:
        """A list."""
        return []

    def restart(self) -> None:
        """Nothing was kept."""

    def resumed(self, _stage: str, _kind: type[State]) -> State | None:
        """Nothing was begun."""
        return None

    def save(self, _stage: str, _state: object) -> None:
        """It is never due."""


class Course(NamedTuple):
    """How a run goes on: who hears how much of it is done, and where it keeps things."""

    tell: Tell = lambda _: None
    work: Work = InMemory()
