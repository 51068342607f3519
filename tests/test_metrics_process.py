"""A live run seen from outside: real processes, asked by HTTP, one of them killed."""

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import psutil
import pytest

pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")

from local_bus import LocalBus
from metrics_reader import Samples, read
from rich.console import Console
from show_page import RIG
from spoiling import copied, edit_json, refilmed
from test_metrics_server import asked, free_address

from common.bus.control_messages import Cameras, Pulse
from common.bus.inbox import Alive
from common.bus.messages import Body, Posture
from common.bus.process import READY_S, ProcessContext
from common.config.part_settings import PageSettings, SettingsError
from common.config.settings import Settings
from runtime.live import session
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from runtime.outside.metrics_process import Desk, main, run
from tritrack.commands.live_commands import metrics

PATIENCE_S = 180.0
PARTS = {"integrator", "recognizer", "viewer 1", "viewer 2", "metrics"}


class Outsider(threading.Thread):
    """Asks a run by HTTP, does it harm, and ends it."""

    def __init__(self, address: str, victim: str, stop: threading.Event) -> None:
        super().__init__()
        self.seen: Samples | None = None
        self.sick = self.after = ""
        self.failure: BaseException | None = None
        self._address, self._victim, self._over = address, victim, stop

    def run(self) -> None:
        try:
            self._until("well", lambda: self._health()[0] == 200 and self._bodies() > 20)
            (part,) = (one for one in psutil.Process().children() if one.name() == self._victim)
            part.kill()
            self._until("sick", self._is_sick)
            self._until("well again", lambda: self._health()[0] == 200)
            self._until("counted", lambda: self._restarts() >= 1)
            self.seen = self._samples()
        except BaseException as error:
            self.failure = error
        finally:
            self._over.set()

    def _until(self, what: str, seen: Callable[[], bool]) -> None:
        until_s = time.monotonic() + PATIENCE_S
        while not seen():
            assert time.monotonic() < until_s, f"waited in vain for {what}: {self._health()}"
            time.sleep(0.05)

    def _health(self) -> tuple[int, str]:
        try:
            return asked(self._address, "/healthz")
        except OSError:
            return 0, "nobody answers yet"

    def _is_sick(self) -> bool:
        code, self.sick = self._health()
        return code == 503 and f"{self._victim}: it " in self.sick

    def _samples(self) -> Samples:
        return read(asked(self._address, "/metrics")[1])

    def _bodies(self) -> float:
        return sum(self._samples().by("status", "tritrack_bodies_total").values())

    def _restarts(self) -> float:
        return self._samples().value("tritrack_restarts_total", part=self._victim)


@pytest.mark.slow
@pytest.mark.parametrize("victim", ["viewer 2", "integrator"])
def test_who_was_killed_is_named_and_all_is_well_when_it_is_back(
    clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, victim: str
) -> None:
    """The integrator is where all meet: with it everybody is gone, and found again."""
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film + 14 * (film[:29:-1] + film[29:]))
    edit_json(folder / "meta.json", lambda meta: meta.update(fps=5.0))
    settings = msgspec.structs.replace(
        free_settings(Settings(room="hall", clip=str(folder), page=PageSettings(port=0))),
        metrics=free_address(),
    )
    stop = threading.Event()
    outsider = Outsider(settings.metrics, victim, stop)
    monkeypatch.setattr(session, "stopped_by_signals", lambda _: nullcontext(stop))
    outsider.start()
    facts = live(settings, tmp_path / "out", Console(quiet=True))
    outsider.join()
    assert outsider.failure is None, outsider.failure
    assert f"{victim}: it " in outsider.sick
    assert set(facts["processes"]) == PARTS
    assert outsider.seen is not None
    tells_the_run(outsider.seen)
    again = Counter(told.split(":")[0] for told in facts["warnings"] if "started again" in told)
    restarts = outsider.seen.by("part", "tritrack_restarts_total")
    assert {part: n for part, n in restarts.items() if n} == again, "the supervisor knows"


def tells_the_run(seen: Samples) -> None:
    assert {labels["room"] for _, labels, _ in seen.samples} == {"hall"}
    frames = seen.by("part", "tritrack_frames_total")
    assert set(frames) == PARTS
    assert all(mb > 20e6 for mb in seen.by("part", "tritrack_resident_memory_bytes").values())
    assert all(age < 5.0 for age in seen.by("part", "tritrack_message_age_seconds").values())
    bodies = seen.by("status", "tritrack_bodies_total")
    assert sum(bodies.values()) > 20
    for part in ("integrator", "recognizer"):
        counts = seen.by("le", "tritrack_latency_seconds_bucket", part=part)
        assert counts["+Inf"] >= counts["0.1"] >= 0
        assert counts["+Inf"] == pytest.approx(sum(bodies.values()), abs=3)
    assert seen.value("tritrack_latency_seconds_sum", part="recognizer") > 0.0


def test_settings_without_an_address_have_no_metrics_to_serve(tmp_path: Path) -> None:
    (tmp_path / "room.toml").write_text("clip = 'walk'")
    with pytest.raises(SettingsError, match=r"room\.toml has no metrics: add metrics = "):
        metrics(tmp_path / "room.toml")


BODY = Body(frame=9, captured_s=0.6, clock_s=99.9, status="tracking", views="both")
PULSE = Pulse(process="viewer 1", state="running", frames=9)


@pytest.fixture
def at_100_s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("runtime.outside.metrics_process.time.monotonic", lambda: 100.0)


@pytest.mark.usefixtures("at_100_s")
def test_a_desk_tells_figures_of_its_room_and_whether_what_is_needed_is_there() -> None:
    desk = Desk(["viewer 1"], "hall")
    well, lines = desk.health()
    assert (well, len(lines)) == (False, 1)
    assert lines[0].startswith("viewer 1: not heard yet")
    for told in (Alive("viewer 1", True), PULSE, BODY):
        desk.take_in(told)
    assert desk.health() == (True, ["hall: well"])
    samples = [each for family in desk.metrics() for each in family.samples]
    assert {each.labels["room"] for each in samples} == {"hall"}
    latency = [each for each in samples if each.name == "tritrack_latency_seconds_sum"]
    assert [each.value for each in latency] == [pytest.approx(0.1)]


@pytest.mark.usefixtures("at_100_s")
def test_what_comes_is_taken_in_until_it_shall_end() -> None:
    """What waits may be nothing for a moment."""
    desk, stop = Desk([], "hall"), threading.Event()
    asked: list[float] = []

    class Box:
        def take(self, within_s: float) -> Body | None:
            asked.append(within_s)
            if len(asked) == 3:
                stop.set()
            return None if len(asked) == 2 else BODY

    desk.hear(Box(), stop)  # type: ignore[arg-type]
    assert asked == [0.5] * 3
    bodies = [
        each.value
        for family in desk.metrics()
        for each in family.samples
        if each.name == "tritrack_bodies_total"
    ]
    assert bodies == [2]


def test_all_that_a_run_says_is_heard_and_the_process_tells_that_it_lives(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also the rig that was said before it came, and who came before it."""
    bus, desk, stop = LocalBus("hall"), Desk(["viewer 1"], "hall"), threading.Event()
    rig = Cameras(rig=RIG, scale_source="person", late_s=0.25)
    bus.keep(Cameras)
    bus.publish(rig)
    bus.announce("viewer 1")
    pulses = bus.subscribe(Pulse)
    monkeypatch.setattr("runtime.outside.metrics_process.HEAR_S", 0.01)
    monkeypatch.setattr("runtime.outside.metrics_process.BEAT_S", 0.02)
    running = threading.Thread(target=run, args=(desk, bus, stop))
    running.start()
    beats: list[Pulse] = []

    def heard(state: str) -> bool:
        beats.extend(one for one in pulses.drain() if one.process == "metrics")
        return any(one.state == state for one in beats)

    until(lambda: heard("running"))
    for told in (PULSE, BODY, Posture(frame=9, captured_s=0.6, clock_s=99.9, name="")):
        bus.publish(told)

    def figures() -> dict[str, float]:
        return {each.name: each.value for one in desk.metrics() for each in one.samples}

    names = ("tritrack_bodies_total", "tritrack_up", "tritrack_view_offset_seconds")
    until(lambda: {*names} <= figures().keys() and desk.health()[0])
    stop.set()
    running.join(10)
    assert not running.is_alive()
    assert heard("ended")
    assert [beats[0].state, beats[-1].state] == ["ready", "ended"]
    assert figures()["tritrack_view_offset_seconds"] == 0.25


def test_metrics_are_served_of_the_settings_room_by_a_process_that_stands_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    bus, stop = LocalBus("hall"), threading.Event()
    place = "runtime.outside.metrics_process"

    @contextmanager
    def opened(name: str, given: tuple[Any, ...], inside: Any) -> Iterator[Any]:
        asked.append((name, given))
        yield inside
        asked.append(f"{name} is closed")

    context = ProcessContext()
    monkeypatch.setattr(f"{place}.process", lambda *given: opened("process", given, stop))
    monkeypatch.setattr(f"{place}.served", lambda *given: opened("served", given, None))
    monkeypatch.setattr(f"{place}.open_client", lambda *given: opened("client", given, bus))
    monkeypatch.setattr(f"{place}.platform", lambda: SimpleNamespace(give_way=asked.append))
    monkeypatch.setattr(f"{place}.run", lambda *given: asked.append(given[1:]))
    watched = bus.watch_alive()
    settings = Settings(room="hall", metrics="127.0.0.1:9464")
    main(settings, ["viewer 1"], context)
    (_, (name, own)), by, (_, (address, figures, health)), (_, client) = asked[:4]
    assert (name, own, by, address) == ("metrics", context, 10, "127.0.0.1:9464")
    assert client == (settings.bus, "hall", READY_S, "metrics", stop)
    assert health()[1][0].startswith("viewer 1: not heard yet")
    assert {each.labels.get("room") for one in figures() for each in one.samples} <= {"hall"}
    assert asked[4:] == [
        (bus, stop),
        *("client is closed", "served is closed", "process is closed"),
    ]
    assert [alive.name for alive in watched.drain()] == ["metrics"]


def until(seen: Callable[[], bool]) -> None:
    until_s = time.monotonic() + 20.0
    while not seen():
        assert time.monotonic() < until_s
        time.sleep(0.01)
