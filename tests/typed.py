"""Commands as they are typed, without the work that they start."""

from collections.abc import Callable
from typing import Any

import pytest
import typer
from typer.testing import CliRunner, Result


def typed(command: Callable[..., None] | typer.Typer, *words: object) -> Result:
    """What one command says and gives, typed with these words; our own errors are raised."""
    app = command
    if not isinstance(app, typer.Typer):
        app = typer.Typer()
        app.command()(command)
    return CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)


class Called:
    """Stands where work would be done: keeps what it was asked for, and answers."""

    def __init__(self, answer: Any = None) -> None:
        self.answer, self.given = answer, list[Any]()

    def __call__(self, *given: Any, **named: Any) -> Any:
        self.given.append((*given, *named.values()))
        return self.answer

    @property
    def last(self) -> Any:
        return self.given[-1]


def instead(patch: pytest.MonkeyPatch, place: str, answer: Any = None) -> Called:
    """Somebody who only notes the call, in the place of a function."""
    called = Called(answer)
    patch.setattr(place, called)
    return called
