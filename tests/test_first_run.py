"""What is compiled beforehand; `test_system_wheel.py` holds that after it nothing compiles."""

from pathlib import Path

import pytest

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
