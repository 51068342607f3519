"""The benchmark of a single view: every part is measured, and together they are the rate."""

from pathlib import Path

import pytest

from common.config.settings import Settings
from tritrack.bench.single_bench import figures


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
