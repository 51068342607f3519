"""The benchmark of a single view: every part is measured, and together they are the rate."""

from pathlib import Path

import cv2
import pytest

from common.config.settings import Settings
from lab.bench import single_bench
from lab.bench.single_bench import Times, figures, parts_ms


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["default", "thesis"])
def test_the_rate_is_what_the_parts_leave(clip: Path, mode: str) -> None:
    """T1, issue 5 (Shows 7): decoding, silhouettes and poses, one after the other."""
    settings = Settings(clip=str(clip), mode="thesis" if mode == "thesis" else "default")
    rate, *parts = figures(settings, repeats=1, target=200.0)
    assert rate[2:] == ("frames/s", 200.0)
    assert f"{mode}, 160x120" in rate[0]
    assert [part[0].split()[1] for part in parts] == ["decoding", "silhouettes", "poses"]
    assert all(part[1] > 0.0 for part in parts)
    assert rate[1] == pytest.approx(1e3 / sum(part[1] for part in parts))


def test_stages_follow_each_other_and_each_is_told_for_a_frame() -> None:
    """20 frames in 0.1, 0.25 and 0.05 seconds: 50 a second, of 5, 12.5 and 2.5 ms."""
    times = Times(20, 0.1, 0.25, 0.05)
    assert times.frames_a_second == pytest.approx(50.0)
    assert parts_ms(times) == pytest.approx(
        {
            "decoding of one view": 5.0,
            "silhouettes of one view": 12.5,
            "poses of one view": 2.5,
        }
    )


def test_pictures_are_worked_on_by_one_thread_and_then_by_as_many_as_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before, seen = cv2.getNumThreads(), []
    cv2.setNumThreads(2)
    try:
        monkeypatch.setattr(
            single_bench, "_followed", lambda *given: seen.append((cv2.getNumThreads(), given[1]))
        )
        single_bench.followed(Settings(), 6)
        assert seen == [(1, 6)]
        assert cv2.getNumThreads() == 2
    finally:
        cv2.setNumThreads(before)
