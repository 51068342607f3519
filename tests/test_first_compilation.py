"""What is compiled before a run's first frames, and when."""

from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from common import cache_folder
from common.platform.platform import Job
from integrator import integrator_warmup
from runtime.warming import first_compilation


def test_what_is_run_first_is_a_program_of_ours_which_compiles_in_silence(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """It is named, not imported: rooms import downward only."""
    called: list[str] = []

    def compile_all() -> None:
        called.append("all")
        print("compiled in 100 s")

    monkeypatch.setattr(import_module(first_compilation.FIRST_RUN), "compile_all", compile_all)
    words: Any = None
    first_compilation.compile_all(words)
    assert called == ["all"]
    assert capfd.readouterr() == ("", "")


class Launcher:
    """Notes the jobs of its workers, and what becomes of these."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
        self.done: list[Any] = []
        monkeypatch.setattr(cache_folder, "compiled_folder", lambda: folder)
        monkeypatch.setattr(first_compilation, "platform", lambda: self)

    def start(self, job: Job) -> Any:
        self.done.append(job.main)
        return SimpleNamespace(worker=self)

    def join(self) -> None:
        self.done.append("waited")

    def kill(self) -> None:
        self.done.append("killed")


def test_a_live_run_waits_until_all_is_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    launcher = Launcher(monkeypatch, tmp_path)
    first_compilation.compile_first()
    assert launcher.done == [first_compilation.compile_all, "waited"]
    cache_folder.mark_of_all().touch()
    first_compilation.compile_first()
    assert len(launcher.done) == 2


def test_a_recorded_clip_is_tracked_beside_it_where_nothing_was_ever_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What failed ends it too."""
    launcher = Launcher(monkeypatch, tmp_path)
    job = first_compilation.compile_integrator

    def fail() -> None:
        with first_compilation.compiling_beside():
            assert launcher.done == [job]
            raise KeyError(job)

    with pytest.raises(KeyError):
        fail()
    assert launcher.done == [job, "killed", "waited"]
    (tmp_path / "of an older state.nbc").touch()
    with first_compilation.compiling_beside():
        assert len(launcher.done) == 3


def test_what_an_integrator_executes_is_compiled_in_silence(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    sizes: list[Any] = []

    def warm_up(_settings: Any, size: Any) -> None:
        sizes.append(size)
        print("a library speaks")

    monkeypatch.setattr(integrator_warmup, "warm_up", warm_up)
    words: Any = None
    first_compilation.compile_integrator(words)
    assert sizes == [first_compilation.SIZE]
    assert capfd.readouterr() == ("", "")
