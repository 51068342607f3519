"""What parts of a run have compiled for them before they begin."""

from typing import Any

import pytest

from runtime.warming import parts_warmup


def test_the_parts_are_warmed_up_in_silence(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(parts_warmup, "warm_up", lambda: print("a library speaks"))
    words: Any = None
    parts_warmup.compile_parts(words)
    assert capfd.readouterr() == ("", "")
