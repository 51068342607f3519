"""A live run seen from outside: real processes, asked by HTTP, one of them killed."""

import threading
import time
from collections import Counter
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import msgspec
import psutil
import pytest

pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")

from metrics_reader import Samples, read
from rich.console import Console
from spoiling import copied, edit_json, refilmed
from test_metrics_server import asked, free_address

from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.config.settings_error import SettingsError
from tritrack.commands.live_commands import metrics
from tritrack.live import session
from tritrack.live.free_ports import free_settings
from tritrack.live.session import live

pytestmark = pytest.mark.slow

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
    monkeypatch.setattr(session, "_stopped_by_signals", lambda _: nullcontext(stop))
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
