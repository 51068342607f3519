"""The fit that goes on beside the retouching page: one at a time; one that fails gives nothing."""

import threading
from collections.abc import Callable

from test_take import take

from animator.retouching.fitting import FitError, Fitting
from animator.take import Take
from common.notes.notes import Note, Notes

SAID = Notes(note=(Note(3, "left"),))


class Page:
    """Writes down what it hears."""

    def __init__(self) -> None:
        self.told: list[tuple[str, bool]] = []
        self.given: list[Notes] = []

    def tell(self, text: str, well: bool) -> None:
        self.told.append((text, well))

    def taken(self, _: Take, notes: Notes) -> None:
        self.given.append(notes)


def test_a_second_press_waits_for_nothing_and_says_that_one_goes_on() -> None:
    page, go_on = Page(), threading.Event()

    def fit(_: Notes, tell: Callable[[str], object]) -> Take:
        tell("half")
        assert go_on.wait(10.0)
        return take()

    fitting = Fitting(fit, page.taken, page.tell)
    fitting.begin(SAID)
    fitting.begin(Notes())
    go_on.set()
    fitting.wait()
    assert page.given == [SAID]
    assert sorted(page.told) == [
        ("fitting the video again", True),
        ("half", True),
        ("the video is still being fitted", False),
    ]
    fitting.begin(Notes())
    fitting.wait()
    assert page.given == [SAID, Notes()], "another one may follow"


def test_a_fit_that_fails_says_why_and_gives_nothing() -> None:
    page = Page()

    def fit(_: Notes, __: Callable[[str], object]) -> Take:
        raise FitError("the disk is full")

    fitting = Fitting(fit, page.taken, page.tell)
    fitting.begin(SAID)
    fitting.wait()
    assert page.given == []
    assert page.told[-1] == ("the disk is full", False)
