"""What is behind the start page, without a server: it goes on whatever fails around it."""

import sys
from pathlib import Path
from typing import Any

import pytest
from waiting import until

from tritrack.starting.job_plan import Plan
from tritrack.starting.job_queue import JobQueue
from tritrack.starting.start_desk import Given, StartDesk


class Page:
    """Keeps what it is given to show."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def next_wish(self) -> None:
        """Nothing is wished."""

    def show(self, section: Any) -> None:
        """Not looked at here."""

    def tell(self, message: Any) -> None:
        self.told.append(message.text)


def test_a_result_that_cannot_be_kept_is_told_and_the_page_goes_on(tmp_path: Path) -> None:
    queue, page, kept = JobQueue([sys.executable, "-c", ""]), Page(), tmp_path / "kept"
    desk = StartDesk(Given(tmp_path / "runs"), queue)
    kept.mkdir()
    queue.add(Plan("calibrate", (), report=kept))

    def is_told() -> bool:
        desk.turn(page)  # type: ignore[arg-type]
        return bool(page.told)

    assert until(is_told)
    assert "see that you may write it" in page.told[0]
    desk.close()


def test_no_command_takes_a_runs_name_for_an_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the present folder a run --force would be one."""
    monkeypatch.chdir(tmp_path)
    desk = StartDesk(Given(Path(".")))
    assert Path(desk.hello.runs) == tmp_path
    desk.close()
