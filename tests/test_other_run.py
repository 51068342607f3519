"""Runs that are not written over: those of other films, or of another command."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from spoiling import copied, refilmed

from common.config.settings import Settings
from runtime.offline.batch import Asked, track_all
from runtime.store.other_run import OtherRun, refuse_other, run_of, run_told
from runtime.store.runs import write_run
from tritrack.single.single import Given, single_all

TRACKED = run_of("track", ["day1/dance.mp4"])


def test_the_same_may_be_done_again_in_other_settings(tmp_path: Path) -> None:
    refuse_other(tmp_path, TRACKED)
    write_run(tmp_path, [], Settings(size="320x240"), TRACKED.facts)
    refuse_other(tmp_path, run_of("track", [str(Path("day1/../day1/dance.mp4").absolute())]))


@pytest.mark.parametrize(
    "other", [run_of("track", ["day2/dance.mp4"]), run_of("single", ["day1/dance.mp4"])]
)
def test_another_film_or_command_is_refused_by_what_is_there(tmp_path: Path, other: object) -> None:
    write_run(tmp_path, [], Settings(), TRACKED.facts)
    assert isinstance(other, type(TRACKED))
    with pytest.raises(OtherRun, match=r"another run \(tritrack track of .*/day1/dance.mp4\)"):
        refuse_other(tmp_path, other)


def test_a_live_run_is_not_written_over_by_that_of_a_film(tmp_path: Path) -> None:
    write_run(tmp_path, [], Settings(), {"processes": {}})
    with pytest.raises(OtherRun, match=r"another run \(tritrack live\): choose another --out"):
        refuse_other(tmp_path, TRACKED)


def test_a_live_run_that_does_not_tell_of_what_gives_way_to_a_live_run(tmp_path: Path) -> None:
    write_run(tmp_path, [], Settings(), {"processes": {}})
    refuse_other(tmp_path, run_of("live", [0, 1]))


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"run_of": 3}'])
def test_what_tells_nothing_of_itself_is_no_hindrance(tmp_path: Path, text: str) -> None:
    (tmp_path / "summary.json").write_text(text)
    refuse_other(tmp_path, TRACKED)


def test_what_a_run_is_of_is_read_back_from_its_summary(tmp_path: Path) -> None:
    """Whole paths of films, numbers of cameras; nothing where there is no run."""
    assert run_told(tmp_path) is None
    for made in (TRACKED, run_of("live", [0, 1]), run_of("replay", [])):
        write_run(tmp_path, [], Settings(), made.facts)
        assert run_told(tmp_path) == made
    assert TRACKED.footage == (str(Path("day1/dance.mp4").absolute()),)
    assert run_of("live", [0, 1]).footage == ("0", "1")
    assert run_of("replay", []).told == "tritrack replay"
    for text in ("[3]", '{"run_of": {"footage": "x"}}', "{"):
        (tmp_path / "summary.json").write_text(text)
        assert run_told(tmp_path) is None


def test_both_commands_leave_the_other_run_as_it_is(clip: Path, tmp_path: Path) -> None:
    write_run(tmp_path / clip.name, [], Settings(), run_of("track", ["other.avi"]).facts)
    write_run(tmp_path / "cam1", [], Settings(), TRACKED.facts)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    said = Console(file=StringIO(), width=500)
    with pytest.raises(OtherRun, match=r"holds another run \(tritrack track of"):
        track_all([clip], tmp_path, Asked(), said)
    (video,) = clip.glob("cam1.*")
    with pytest.raises(OtherRun):
        single_all([video], tmp_path, Given(), Settings(), said)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.slow
def test_a_run_that_is_made_again_or_by_force_takes_the_others_place(
    clip: Path, tmp_path: Path
) -> None:
    write_run(tmp_path / clip.name, [], Settings(), run_of("track", ["other.avi"]).facts)
    short = copied(clip, tmp_path / "short" / clip.name)
    refilmed(short, lambda film: film[:8])
    said = Console(file=StringIO(), width=500)
    for force in (True, False):
        track_all([short], tmp_path, Asked(size="160x120", force=force), said)
