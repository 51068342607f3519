"""What is compiled beforehand: after it no command of every day compiles."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from tritrack import first_run


def said(cache: Path | None, *words: str) -> str:
    """What a module's command says, whose compiled code is in a folder, or where it always is."""
    own = {} if cache is None else {"NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-m", *words],
        env={**os.environ, **own},
        check=True,
        text=True,
        capture_output=True,
    )
    return done.stdout


class First(NamedTuple):
    """A first run: the one place of the slow tests where a checkout compiles anew."""

    cache: Path
    run: Path


@pytest.fixture(scope="module")
def first(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> First:
    """Of a live run, where nobody let anything be compiled before."""
    folder = tmp_path_factory.mktemp("first")
    settings = folder / "live.toml"
    settings.write_text(
        f'clip = "{clip}"\nsize = "160x120"\n[bus]\nendpoint = "auto"\n[page]\nport = 0\n'
    )
    said(folder / "cache", "tritrack", "live", str(settings), "--out", str(folder / "run"))
    return First(folder / "cache", folder / "run")


@pytest.fixture(scope="module")
def anew(first: First) -> Path:
    return first.cache


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="parts of a run are forked on Linux alone")
def test_a_first_live_run_compiles_before_its_clip_begins_and_not_in_its_midst(
    first: First,
) -> None:
    """Else its integrator stands still for seconds, and is killed as one that hangs."""
    summary = json.loads((first.run / "summary.json").read_text())
    assert summary["frames"] > 60
    began_s = (first.run / "poses.npz").stat().st_mtime - (summary["frames"] - 1) / 15
    compiled = list(first.cache.rglob("*.nbc"))
    assert len(compiled) > 100
    assert max(path.stat().st_mtime for path in compiled) < began_s
    assert not [told for told in summary["warnings"] if "killed" in told]


def compiled_of(cache: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in cache.rglob("*.nbc")}


@pytest.mark.slow
def test_after_the_first_run_no_command_of_every_day_compiles(
    anew: Path, clip: Path, tmp_path: Path
) -> None:
    before = compiled_of(anew)
    assert len(before) > 100
    assert said(anew, "tritrack.first_run") == ""
    for words in (
        ("track", str(clip)),
        ("track", str(clip), "--views", "1"),
        ("single", str(clip / "cam1.avi")),
    ):
        said(anew, "tritrack", *words, "--out", str(tmp_path / "out"))
        assert compiled_of(anew) == before, words
    assert not [path for path in before if b"__mp_main__" in path.read_bytes()]
    assert not [path for path in before if b"__main__" in path.read_bytes()]


@pytest.mark.slow
def test_nor_does_a_live_run_whose_cameras_nobody_calibrated(
    anew: Path, clip: Path, tmp_path: Path
) -> None:
    """Its viewers fit a stick figure until the rig is known: compiled in their midst, that would
    make them hang for the first ten seconds of the first run."""
    before = compiled_of(anew)
    shutil.copytree(clip, tmp_path / "bare" / clip.name)
    settings = tmp_path / "live.toml"
    settings.write_text(
        f'clip = "{tmp_path / "bare" / clip.name}"\nsize = "160x120"\n'
        '[bus]\nendpoint = "auto"\n[page]\nport = 0\n'
    )
    said(anew, "tritrack", "live", str(settings), "--out", str(tmp_path / "run"))
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert [told for told in summary["warnings"] if told.startswith("no calibration")]
    assert not [told for told in summary["warnings"] if "killed" in told]
    assert compiled_of(anew) == before


@pytest.mark.slow
def test_what_is_compiled_anew_gives_the_same_bytes(anew: Path, clip: Path, tmp_path: Path) -> None:
    """As what another process compiled before."""
    for cache, out in ((anew, "anew"), (None, "before")):
        said(cache, "tritrack", "track", str(clip), "--out", str(tmp_path / out))
    first, second = (tmp_path / out / clip.name / "poses.npz" for out in ("anew", "before"))
    assert first.read_bytes() == second.read_bytes()


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
