"""A view that is lost in a live run: real processes that are killed, frozen, covered or cut off."""

import json
import multiprocessing
import os
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from rich.console import Console
from spoiling import Film, copied, edit_json, refilmed

from common.bus import BusError, open_client
from common.config import BusSettings, PageSettings, Settings
from common.messages import Body, Pulse, Views
from tritrack import session
from tritrack.offline import Decoders, track_clip
from tritrack.parts import Part, live_parts
from tritrack.runs import poses
from tritrack.session import free_settings, live

pytestmark = pytest.mark.slow

RATE_HZ = 5.0
"""A third of the cameras' rate: what a busy machine keeps up with."""
PATIENCE_S = 90.0
MOTION = 29
"""First frame after the opening posture."""
LOST = slice(45, 61)
"""Frames in which camera 2 is covered."""


@pytest.fixture(scope="module")
def long_clip(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The made-up clip, its motion there and back, slow: a viewer has time to come back."""
    folder = copied(clip, tmp_path_factory.mktemp("long") / "clip")
    refilmed(folder, lambda film: film + film[:MOTION:-1] + film[MOTION:])
    edit_json(folder / "meta.json", lambda meta: meta.update(fps=RATE_HZ))
    return folder


def settings_of(clip: Path) -> Settings:
    return free_settings(Settings(clip=str(clip), page=PageSettings(port=0)))


class Witness:
    """Hears a run from outside, and does it harm at the right moment."""

    def __init__(self, bus: BusSettings, harm: Callable[["Witness"], None]) -> None:
        self.bodies: list[Body] = []
        self.said: list[str] = []
        self.states: list[tuple[str, str]] = []
        self._settings, self._harm = bus, harm
        self._thread = threading.Thread(target=self._run)
        self.failure: BaseException | None = None

    def __enter__(self) -> "Witness":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.join()
        if self.failure is not None:
            raise self.failure

    def _run(self) -> None:
        try:
            with self._door() as bus:
                self._bus_bodies, self._bus_pulses = bus.subscribe(Body), bus.subscribe(Pulse)
                self._harm(self)
        except BaseException as error:
            self.failure = error

    @contextmanager
    def _door(self) -> Iterator[Any]:
        until_s = time.monotonic() + PATIENCE_S
        while True:
            try:
                with open_client(self._settings, "room", 1.0) as bus:
                    yield bus
                return
            except BusError:
                if time.monotonic() > until_s:
                    raise

    def until(self, what: str, seen: Callable[[], bool]) -> None:
        """Listen until something was seen."""
        until_s = time.monotonic() + PATIENCE_S
        while not seen():
            assert time.monotonic() < until_s, f"waited in vain for {what}"
            body = self._bus_bodies.take(0.02)
            self.bodies += [] if body is None else [body, *self._bus_bodies.drain()]
            for pulse in self._bus_pulses.drain():
                self.states.append((pulse.process, pulse.state))
                self.said += [x for x in pulse.detail.splitlines() if x not in self.said]

    def until_views(self, views: Views, frames: int = 3) -> None:
        """Listen until the last few bodies were made of these views."""
        start = len(self.bodies)
        self.until(
            f"views {views}",
            lambda: (
                len(self.bodies) >= start + frames
                and all(body.views == views for body in self.bodies[-frames:])
            ),
        )

    def until_tracked(self) -> None:
        self.until(
            "a measured body",
            lambda: (
                any(body.status == "measuring" for body in self.bodies)
                and self.bodies[-1].status == "tracking"
            ),
        )
        self.until_views("both")

    def until_said(self, words: str) -> None:
        self.until(words, lambda: any(words in line for line in self.said))


def pid_of(name: str) -> int:
    """Of this test's own part."""
    (pid,) = (one.pid for one in multiprocessing.active_children() if one.name == name)
    assert pid is not None
    return pid


def bodies_of(found: dict[str, Any], views: str) -> int:
    return int(np.count_nonzero(found["views"] == views))


def rows(out: Path) -> dict[str, Any]:
    with np.load(out / "poses.npz", allow_pickle=False) as found:
        return dict(found)


def goes_on_with_view_1_and_comes_back(out: Path, witness: Witness) -> None:
    """What every loss of view 2 has in common (issue 5, Shows 5)."""
    found = rows(out)
    assert np.diff(found["frame"]).max() <= 3, "a gap in the stream"
    lone = np.flatnonzero(found["views"] == "1")
    assert np.isfinite(found["joints_m"][lone]).all()
    assert set(found["views"][lone[-1] + 1 :]) <= {"both", "1", "none"}
    assert "both" in found["views"][lone[0] :], "two views never resumed"
    measured = [body.bdp for body in witness.bodies if body.status == "tracking"]
    assert all(status != "measuring" for status in found["status"][lone[0] :])
    assert measured[-1] is not None
    assert np.allclose(measured[-1].lengths(), measured[0].lengths(), rtol=0.4)


def test_a_killed_viewer_is_started_again_and_the_body_goes_on(
    long_clip: Path, tmp_path: Path
) -> None:
    def harm(witness: Witness) -> None:
        witness.until_tracked()
        os.kill(pid_of("viewer 2"), signal.SIGKILL)
        witness.until_views("1")
        witness.until_said("view 2 is lost (it was killed, or its link is cut); view 1 goes on")
        witness.until_views("both")
        witness.until_said("view 2 is back")

    settings = settings_of(long_clip)
    with Witness(settings.bus, harm) as witness:
        facts = live(settings, tmp_path, Console(quiet=True))
    goes_on_with_view_1_and_comes_back(tmp_path, witness)
    assert any("viewer 2: killed by signal 9; it is started again" in w for w in facts["warnings"])
    log = (tmp_path / "log.txt").read_text()
    assert "supervisor  WARNING viewer 2: killed by signal 9" in log
    assert "view 2 is lost" in log
