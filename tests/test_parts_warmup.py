"""What parts of a run have compiled for them before they begin."""

from importlib import import_module
from typing import Any

import pytest

from runtime.warming import parts_warmup


def test_what_is_run_first_is_a_program_of_ours_which_compiles_in_silence(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """It is named, not imported: rooms import downward only."""
    called: list[str] = []

    def compile_all() -> None:
        called.append("all")
        print("compiled in 100 s")

    monkeypatch.setattr(import_module(parts_warmup.FIRST_RUN), "compile_all", compile_all)
    words: Any = None
    parts_warmup.compile_all(words)
    assert called == ["all"]
    assert capfd.readouterr() == ("", "")


def test_the_parts_are_warmed_up_in_silence(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(parts_warmup, "warm_up", lambda: print("a library speaks"))
    words: Any = None
    parts_warmup.compile_parts(words)
    assert capfd.readouterr() == ("", "")
