"""Storage of a run's intermediate results: in memory, or on disk for resuming."""

from typing import Any, NamedTuple, Protocol, TypeVar

from runtime.terminal import Tell
from runtime.unfinished.message_file import MessageFile

State = TypeVar("State")
Kept = list[Any] | MessageFile[Any]
"""A growing sequence of messages in the order in which they came."""


class Work(Protocol):
    """Storage of a run in progress."""

    @property
    def due(self) -> bool:
        """Whether the state is due to be saved."""

    def messages(self, name: str) -> Kept:
        """Messages of one kind, up to their saved extent."""

    def resumed(self, stage: str, kind: type[State]) -> State | None:
        """The saved state of a stage; None where it was not begun, or is over."""

    def save(self, stage: str, state: object) -> None:
        """Save the state of a stage, in case the run is cut short."""

    def restart(self) -> None:
        """The run begins again: saved results are discarded at their next request."""


class InMemory:
    """Nothing outlives the run."""

    due = False

    def messages(self, _name: str) -> Kept:
        """A list."""
        return []

    def restart(self) -> None:
        """Nothing was saved."""

    def resumed(self, _stage: str, _kind: type[State]) -> State | None:
        """Nothing was begun."""
        return None

    def save(self, _stage: str, _state: object) -> None:
        """It is never due."""


class Course(NamedTuple):
    """Context of a run: who receives its progress, and where results are stored."""

    tell: Tell = lambda _: None
    work: Work = InMemory()
