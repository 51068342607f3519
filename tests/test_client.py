"""tritrack in one's own program: loops that begin and end with a run, and the examples in docs."""

import asyncio
import subprocess
import sys
from pathlib import Path

import pytest
from meeting import free_endpoint, saying

from common.bus.bus import BusError
from common.bus.messages import Body
from tritrack import subscribe, track

EXAMPLES = Path(__file__).parents[1] / "docs" / "examples"


def test_a_loop_hears_every_body_and_ends_with_the_run() -> None:
    with saying(frames=20, wait_s=2.0) as endpoint:
        frames = [body.frame for body in subscribe(endpoint, wait_s=5.0)]
    assert frames == list(range(20))


def test_an_async_loop_hears_them_too_and_lets_others_run() -> None:
    ticks = 0

    async def tick() -> None:
        nonlocal ticks
        while True:
            await asyncio.sleep(0.01)
            ticks += 1

    async def hear(endpoint: str) -> list[Body]:
        ticking = asyncio.create_task(tick())
        heard = [body async for body in subscribe(endpoint, kind=Body, wait_s=5.0)]
        ticking.cancel()
        return heard

    with saying(frames=20, wait_s=2.0) as endpoint:
        heard = asyncio.run(hear(endpoint))
    assert [body.frame for body in heard] == list(range(20))
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


def test_track_gives_the_bodies_of_a_clip(clip: Path) -> None:
    bodies = track(clip)
    assert [body.frame for body in bodies] == list(range(len(bodies)))
    assert sum(bool(body.joints_m) for body in bodies) > len(bodies) / 2


def run_example(name: str, argument: str) -> str:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), argument],
        capture_output=True,
        check=False,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_example_of_a_live_elbow_ends_with_the_run() -> None:
    with saying(frames=90, wait_s=2.0) as endpoint:
        lines = run_example("live_elbow.py", endpoint).splitlines()
    assert lines[-1] == "the run is over"
    assert len(lines) > 10
    assert lines[0].endswith("degrees")


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
