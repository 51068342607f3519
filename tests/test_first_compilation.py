"""What is compiled before a run's first frames, and when."""

from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from common import cache_folder
from common.platform.platform import Job
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


def test_a_recorded_clip_waits_for_it_only_where_nothing_was_ever_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A live run waits after each change of the sources too."""
    begun: list[Any] = []

    def start(job: Job) -> Any:
        begun.append(job.main)
        return SimpleNamespace(worker=SimpleNamespace(join=lambda: begun.append("waited")))

    monkeypatch.setattr(cache_folder, "compiled_folder", lambda: tmp_path)
    launcher = SimpleNamespace(start=start)
    monkeypatch.setattr(first_compilation, "platform", lambda: launcher)
    whole = [first_compilation.compile_all, "waited"]
    first_compilation.compile_on_a_new_machine()
    assert begun == whole
    (tmp_path / "all-an older state").touch()
    first_compilation.compile_on_a_new_machine()
    assert begun == whole
    first_compilation.compile_first()
    assert begun == 2 * whole
    cache_folder.mark_of_all().touch()
    first_compilation.compile_first()
    assert begun == 2 * whole
