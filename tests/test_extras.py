"""What only some commands need: a command that lacks it says so before it works."""

from pathlib import Path

import pytest

import tritrack.__main__ as door
from runtime.faults import MENDABLE, code_of
from tritrack.extras import ExtraMissing, refuse_without


def test_what_is_missing_is_named_with_the_extra_that_brings_it() -> None:
    refuse_without("report", "json", "numpy")
    with pytest.raises(ExtraMissing, match=r"^this needs no_such, no_other: pip install .*\[x\]'$"):
        refuse_without("x", "no_such", "json", "no_other")


@pytest.mark.parametrize(
    ("words", "extra"),
    [
        ("teach star_jump a b c --out mine.npz", "learn"),
        ("train a --out mine.npz", "learn"),
        ("evaluate postures a --out report", "report"),
        ("evaluate tracking a --out report", "report"),
        ("demo --out run", "page"),
        ("calibrate board --print board.pdf", "report"),
    ],
)
def test_a_command_says_so_before_it_looks_at_its_clips(
    words: str, extra: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tritrack.extras.find_spec", lambda _: None)
    with pytest.raises(ExtraMissing, match=rf"pip install 'tritrack\[{extra}\]'") as raised:
        door.app(words.split(), standalone_mode=False)
    assert code_of(raised.value) == MENDABLE
    assert not list(tmp_path.iterdir())
