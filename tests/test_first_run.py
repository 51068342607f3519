"""What is compiled beforehand; `test_system_wheel.py` holds that after it nothing compiles."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from common.platform import platforms
from common.platform.platform import Job
from runtime.warming import parts_warmup
from tritrack import first_run


def test_a_first_run_that_was_broken_off_is_begun_again_and_a_whole_one_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mark, runs = tmp_path / "all", list[str]()

    def broken_off() -> None:
        runs.append("broken off")
        raise KeyboardInterrupt

    monkeypatch.setattr(first_run, "mark_of_all", lambda: mark)
    monkeypatch.setattr(first_run, "_run_all", broken_off)
    with pytest.raises(KeyboardInterrupt):
        first_run.compile_all()
    assert not mark.exists()
    monkeypatch.setattr(first_run, "_run_all", lambda: runs.append("whole"))
    first_run.compile_all()
    first_run.compile_all()
    assert runs == ["broken off", "whole"]
    assert mark.exists()


@pytest.mark.parametrize("exitcode", [0, 1])
def test_tracking_and_the_parts_of_a_live_run_compile_beside_each_other(
    monkeypatch: pytest.MonkeyPatch, exitcode: int
) -> None:
    """Where the process beside fails, its work is done here, and so its error is said."""
    done: list[Any] = []

    def start(job: Job) -> Any:
        done.append(job.main)
        worker = SimpleNamespace(join=lambda: done.append("waited"), exitcode=exitcode)
        return SimpleNamespace(worker=worker)

    def noted(word: str) -> Callable[[], None]:
        return lambda: done.append(word)

    monkeypatch.setattr(platforms, "platform", lambda: SimpleNamespace(start=start))
    monkeypatch.setattr(first_run, "_track", noted("tracked"))
    monkeypatch.setattr(parts_warmup, "warm_up", noted("here"))
    first_run._run_all()
    assert done == [parts_warmup.compile_parts, "tracked", "waited", *["here"] * exitcode]
