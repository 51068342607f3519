"""tritrack in one's own program: loops that begin and end with a run, and the examples in docs."""

import asyncio
import doctest
import shutil
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from meeting import EARLY, free_endpoint, saying
from threadpoolctl import threadpool_info, threadpool_limits

import tritrack
from common.bus.bus import BusError
from common.bus.messages import MOST_VIEWS, Body
from runtime.offline import lockstep
from tritrack import Posture, View, subscribe, track
from tritrack.exporting import ExportError

EXAMPLES = Path(__file__).parents[1] / "docs" / "examples"


def test_a_clip_is_tracked_by_its_settings_with_the_views_that_are_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[Any] = []

    def tracked(settings: Any, decoders: Any, views: Any) -> Any:
        asked.append((settings.clip, sorted(decoders.of), views))
        return SimpleNamespace(bodies=iter(["a", "b"]))

    monkeypatch.setattr(lockstep, "track_clip", tracked)
    bodies: list[object] = [*track(tmp_path, (2,))]
    assert bodies == ["a", "b"]
    assert asked == [(str(tmp_path), [*range(1, MOST_VIEWS + 1)], (2,))]


def test_a_loop_hears_every_body_and_ends_with_the_run() -> None:
    frames: list[int] = []
    begin = threading.Event()
    with saying(20, begin) as endpoint:
        for body in subscribe(endpoint, wait_s=5.0):
            frames.append(body.frame)
            begin.set()
    assert [frame for frame in frames if frame != EARLY] == list(range(20))


def test_a_loop_of_one_person_hears_their_bodies_alone() -> None:
    heard: list[tuple[int, int]] = []
    begin = threading.Event()
    with saying(20, begin, people=(1, 2, 3)) as endpoint:
        for body in subscribe(endpoint, wait_s=5.0, person=2):
            heard.append((body.person, body.frame))
            begin.set()
    assert {person for person, _ in heard} == {2}
    assert [frame for _, frame in heard if frame != EARLY] == list(range(20))


def test_one_person_of_views_that_show_everyone_is_refused() -> None:
    with pytest.raises(ValueError, match="a View is of no one person: leave person out"):
        subscribe(kind=View, person=2)
    assert subscribe(kind=Posture, person=2)


def test_an_async_loop_hears_them_too_and_lets_others_run() -> None:
    ticks = 0

    async def tick() -> None:
        nonlocal ticks
        while True:
            await asyncio.sleep(0.01)
            ticks += 1

    async def hear(endpoint: str) -> list[int]:
        frames: list[int] = []
        ticking = asyncio.create_task(tick())
        async for body in subscribe(endpoint, kind=Body, wait_s=5.0):
            frames.append(body.frame)
            begin.set()
        ticking.cancel()
        return frames

    begin = threading.Event()
    with saying(20, begin) as endpoint:
        frames = asyncio.run(hear(endpoint))
    assert [frame for frame in frames if frame != EARLY] == list(range(20))
    assert ticks > 20


def test_a_loop_can_be_left_and_begun_again() -> None:
    with saying(frames=300) as endpoint:
        for _ in range(2):
            for body in subscribe(endpoint, wait_s=5.0):
                assert len(body.joints_m) == 15
                break


def test_nobody_at_the_endpoint_is_said() -> None:
    with pytest.raises(BusError, match="nobody answers at"):
        next(iter(subscribe(free_endpoint(), wait_s=0.3)))


@pytest.mark.slow
def test_track_gives_the_bodies_of_a_clip(clip: Path) -> None:
    bodies = track(clip)
    assert [body.frame for body in bodies] == list(range(len(bodies)))
    assert sum(bool(body.joints_m) for body in bodies) > len(bodies) / 2


@pytest.mark.slow
def test_track_takes_one_thread_of_numpys_and_gives_back_what_the_program_had(
    clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def threads() -> set[int]:
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    meanwhile: list[set[int]] = []
    tracked = lockstep.track_clip

    def watched(*given: Any) -> lockstep.Tracked:
        meanwhile.append(threads())
        return tracked(*given)

    monkeypatch.setattr(lockstep, "track_clip", watched)
    with threadpool_limits(2):
        track(clip)
        assert (meanwhile, threads()) == ([{1}], {2})


def run_example(name: str, argument: str, began: threading.Event | None = None) -> str:
    """What it prints, of which the first line sets an event."""
    example = subprocess.Popen(
        [sys.executable, "-u", str(EXAMPLES / name), argument],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert example.stdout is not None
    said = example.stdout.readline()
    if began is not None:
        began.set()
    said += example.communicate(timeout=120)[0]
    assert example.returncode == 0
    return said


def test_the_example_of_a_live_elbow_ends_with_the_run() -> None:
    begin = threading.Event()
    with saying(20, begin) as endpoint:
        lines = run_example("live_elbow.py", endpoint, begin).splitlines()
    assert lines[-1] == "the run is over"
    assert len(lines) > 10
    assert lines[0].endswith("degrees")


@pytest.mark.slow
def test_the_example_of_a_clip_finds_a_raised_wrist(clip: Path) -> None:
    height_m = float(run_example("highest_wrist.py", str(clip)).split()[0])
    assert 0.5 < height_m < 2.5


def test_the_example_without_tritrack_hears_ten_bodies() -> None:
    pytest.importorskip("msgpack", reason="pip install msgpack")
    with saying(frames=900) as endpoint:
        lines = run_example("plain_zenoh.py", endpoint).splitlines()
    assert len(lines) == 10
    assert all(line.split()[1] == "tracking" for line in lines)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_an_example_is_short_and_the_plain_one_is_plain(path: Path) -> None:
    text = path.read_text()
    assert len(text.splitlines()) <= 20
    if path.name == "plain_zenoh.py":
        assert "tritrack import" not in text
        assert "common" not in text


@pytest.mark.slow
def test_the_examples_of_the_reference_are_true(
    clip: Path, recorded_run: Path, tmp_path: Path
) -> None:
    run = shutil.copytree(recorded_run, tmp_path / clip.name)
    examples = doctest.DocTestFinder()
    names = ("subscribe", "track", "load_run", "export")
    with saying(120) as endpoint:
        known = {"clip": clip, "folder": run, "endpoint": endpoint}
        for name in names:
            (example,) = examples.find(getattr(tritrack, name), name, globs=known)
            done = doctest.DocTestRunner().run(example)
            assert (name, done.failed, done.attempted > 1) == (name, 0, True)


def test_a_format_that_there_is_not_is_refused_by_name(recorded_run: Path, tmp_path: Path) -> None:
    run = shutil.copytree(recorded_run, tmp_path / "run")
    with pytest.raises(ExportError, match="there is no format 'max': there are bvh, "):
        tritrack.export(run, "max")  # type: ignore[arg-type]
    written = tritrack.export(str(run), "bvh", run / "further.bvh", scale="cm")
    assert written["files"] == [str(run / "further.bvh")]
    assert (run / "further.bvh").read_text().startswith("HIERARCHY")


def test_the_old_name_of_a_view_works_with_a_word_on_the_new_one() -> None:
    import tritrack

    with pytest.warns(DeprecationWarning, match=r"use tritrack\.View"):
        old = tritrack.Report
    assert old is tritrack.View
    assert "Report" not in tritrack.__all__


def test_each_error_that_a_public_function_names_can_be_caught_by_a_public_name(
    tmp_path: Path,
) -> None:
    import tritrack

    with pytest.raises(tritrack.SettingsError):
        tritrack.subscribe("tcp/127.0.0.1:7447", keys="keys")
    with pytest.raises(tritrack.ClipError):
        tritrack.track(tmp_path)
    with pytest.raises(tritrack.PastRunError):
        tritrack.load_run(tmp_path)
    with pytest.raises(tritrack.ExportError):
        tritrack.export(tmp_path, "max")  # type: ignore[arg-type]
    with pytest.raises(tritrack.CalibrationError):
        tritrack.Tracker(tmp_path / "none.json")
    named = [getattr(tritrack, name) for name in tritrack.__all__ if name.endswith("Error")]
    assert all(issubclass(each, Exception) for each in [*named, tritrack.DecoderDied])
