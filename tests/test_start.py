"""The start page in a real browser: dropped videos, runs, cameras, calibrations."""

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab
from test_live import CHROMIUM, SIZES, SOFT, Looking
from test_page_server import free_port

from animator.page.door import Entrance, invitation_of
from animator.start.start_page import StartPage
from tritrack.starting.start import LOOK_S
from tritrack.starting.start_desk import Given, StartDesk

TOKEN = "a-long-word"
WORK_S = 280.0
"""For one job: a busy machine compiles nothing, but tracks slowly."""


class Started(NamedTuple):
    """A start page at work in this process."""

    runs: Path
    address: str


@pytest.fixture
def started(tmp_path: Path, clip: Path) -> Iterator[Started]:
    """With an empty folder of runs, and a clip's videos as cameras."""
    videos = tuple(sorted(clip.glob("cam*.avi")))
    runs, port, entrance = tmp_path / "runs", free_port(), Entrance(token=TOKEN)
    desk = StartDesk(Given(runs, videos))
    page = StartPage(desk.hello, desk.file, port, entrance)
    over = threading.Event()

    def serve() -> None:
        while not over.wait(LOOK_S):
            desk.turn(page)

    thread = threading.Thread(target=serve)
    thread.start()
    yield Started(runs, invitation_of(entrance, port))
    over.set()
    thread.join()
    page.close()
    desk.close()


@pytest.fixture
def looking(started: Started) -> Iterator[Looking]:
    if CHROMIUM is None:
        pytest.skip("no Chromium here: the page is not looked at")
    with open_tab(CHROMIUM, SOFT) as tab:
        found = Looking(tab, started.address, SIZES["desk"])
        assert found.until("document.body?.dataset.heard")
        yield found


def choose(looking: Looking, *files: Path) -> None:
    """As a person does in the browser's own dialog."""
    made = looking.tab.call(
        "Runtime.evaluate", expression="document.getElementById('choose-files')"
    )
    looking.tab.call(
        "DOM.setFileInputFiles",
        files=[str(path) for path in files],
        objectId=made["result"]["objectId"],
    )


def click(looking: Looking, what: str) -> None:
    assert looking.until(f"(e => !!e && !e.disabled)(document.querySelector({what!r}))"), what
    looking.ask(f"document.querySelector({what!r}).click()")


def words(looking: Looking, where: str) -> str:
    return str(looking.ask(f"document.querySelector({where!r})?.innerText ?? ''"))


def job_ended(looking: Looking) -> str:
    """The state of the newest job, once it is over."""
    state = "document.querySelector('#jobs li')?.dataset.state"
    over = f"['done', 'failed', 'cancelled'].includes({state})"
    assert looking.until(over, WORK_S), words(looking, "#jobs")
    return str(looking.ask(state))


@pytest.mark.slow
def test_a_dropped_video_becomes_a_run_that_is_exported_and_deleted(
    looking: Looking, started: Started, clip: Path
) -> None:
    choose(looking, clip / "cam1.avi")
    assert looking.until("!!document.querySelector('#do-single')")
    told = words(looking, "#files")
    assert "cam1.avi" in told
    assert "160x120" in told
    assert "at 15 a second" in told
    looking.ask("document.querySelector('#name').select()")
    looking.tab.call("Input.insertText", text="walk")
    click(looking, "#do-single")
    assert looking.until("document.querySelector('#jobs progress')?.value > 0.05", WORK_S)
    assert f"tritrack single {started.runs}/.clips/walk/walk.avi" in words(looking, "#jobs")
    assert looking.until("/cutting out|posing/.test(document.querySelector('#jobs').innerText)")
    assert job_ended(looking) == "done", words(looking, "#jobs")
    assert (started.runs / "walk/poses.npz").is_file()
    assert looking.until("document.querySelector('#runs img')?.naturalWidth > 100")
    assert "believed in" in words(looking, "#runs")

    looking.ask("document.querySelector('#format-walk').value = 'csv'")
    click(looking, "#export-walk")
    assert job_ended(looking) == "done", words(looking, "#jobs")
    link = "document.querySelector('#runs a[download=\"walk_poses.csv\"]')"
    assert looking.until(f"!!{link}")
    rows = looking.tab.call(
        "Runtime.evaluate",
        expression=f"fetch({link}.href).then(got => got.text())",
        awaitPromise=True,
    )["result"]["value"].splitlines()
    with np.load(started.runs / "walk/poses.npz") as poses:
        assert len(rows) == len(poses["frame"]) + 1

    click(looking, "#delete-walk")
    assert looking.until("document.querySelector('#asking').open")
    looking.ask("document.querySelector('#asking button[value=no]').click()")
    looking.drawn()
    assert (started.runs / "walk").is_dir(), "keeping it keeps it"
    click(looking, "#delete-walk")
    looking.ask("document.querySelector('#asking button[value=yes]').click()")
    assert looking.until("!document.querySelector('#runs li')")
    assert not (started.runs / "walk").exists()
    assert not (started.runs / ".clips/walk").exists()
    assert all(
        address.startswith(("http://127.0.0.1", "ws://127.0.0.1", "data:"))
        for address in looking.tab.asked
        if address != "about:blank"
    )
