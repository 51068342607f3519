"""A live run that keeps its pictures: real processes, and the clip that they leave is tracked."""

import json
import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from rich.console import Console
from spoiling import copied, edit_json, film_of

from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.rig.rig_file import load_rig
from common.video.clips import open_clip
from runtime.live.free_ports import free_settings
from runtime.live.launch import Heard
from runtime.live.session import live
from runtime.offline.batch import Asked, track_all

pytestmark = [pytest.mark.slow, pytest.mark.live]

RATE_HZ = 5.0
"""A third of the clip's rate: what a busy machine keeps up with."""


@pytest.fixture(scope="module")
def slow_clip(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = copied(clip, tmp_path_factory.mktemp("slow") / "clip")
    edit_json(folder / "meta.json", lambda meta: meta.update(fps=RATE_HZ))
    return folder


def lived(clip: Path, out: Path, **how: Any) -> dict[str, Any]:
    """A live run that looks at pictures of half the size, and keeps whole ones."""
    own = Settings(clip=str(clip), page=PageSettings(port=0), size="80x60")
    return live(free_settings(own), out, Console(quiet=True), pictures=True, **how)


def assert_same_film(kept: list[np.ndarray], played: list[np.ndarray]) -> None:
    """Each picture is the one that was played, but for its compression, and not the one beside."""
    assert len(kept) == len(played)
    for n, picture in enumerate(kept):
        off = [np.abs(picture.astype(int) - other).mean() for other in played]
        assert off[n] < 2.0
        beside = [off[m] for m in (n - 1, n + 1) if 0 <= m < len(off)]
        assert off[n] <= min(beside) or max(abs(off[n] - one) for one in beside) < 0.3


def test_the_clip_that_a_live_run_keeps_is_what_was_played_and_is_tracked(
    slow_clip: Path, tmp_path: Path
) -> None:
    facts = lived(slow_clip, tmp_path / "run")
    pictures = tmp_path / "run" / "pictures"
    names = {"cam1.avi", "cam2.avi", "calibration.json", "meta.json"}
    assert {path.name for path in pictures.iterdir()} == names
    for camera in ("cam1", "cam2"):
        played = film_of(slow_clip / f"{camera}.avi")
        assert_same_film(film_of(pictures / f"{camera}.avi"), played)
        told = facts["pictures"][camera]
        assert told == {"frames": len(played), "fps": RATE_HZ, "missing": 0}
        times_s = json.loads((pictures / "meta.json").read_text())["capture_s"][camera]
        assert times_s == pytest.approx([n / RATE_HZ for n in range(len(played))], abs=1e-4)
    assert not [line for line in facts["warnings"] if "picture" in line]
    assert load_rig(pictures / "calibration.json").width == 80, "scaled to any size of that shape"
    again, first = (tracked(each, tmp_path / name) for each, name in
                    ((pictures, "again"), (slow_clip, "first")))  # fmt: skip
    off_mm = 1e3 * np.linalg.norm(again["joints_m"] - first["joints_m"], axis=2)
    assert np.nanmedian(off_mm) < 5.0
    assert list(again["frame"]) == list(first["frame"])


def tracked(clip: Path, out: Path) -> Any:
    track_all([clip], out, Asked(), Console(quiet=True))
    return np.load(out / clip.name / "poses.npz", allow_pickle=False)


def test_what_a_killed_viewer_kept_stays_and_its_successor_begins_a_further_file(
    slow_clip: Path, tmp_path: Path
) -> None:
    killed: list[int] = []

    def kill(heard: Heard) -> None:
        pulse = heard.pulses.get("viewer 2")
        if not killed and pulse is not None and pulse.frames > 10:
            viewers = (one for one in psutil.Process().children() if one.name() == "viewer 2")
            killed.append(next(viewers).pid)
            os.kill(killed[0], signal.SIGKILL)

    facts = lived(slow_clip, tmp_path, tell=kill)
    assert killed
    kept = {name: told["frames"] for name, told in facts["pictures"].items()}
    assert [*kept] == ["cam1", "cam2", "cam2_2"]
    played = film_of(slow_clip / "cam2.avi")
    assert kept["cam1"] == len(played)
    first, second = (film_of(tmp_path / "pictures" / f"cam2{part}.avi") for part in ("", "_2"))
    assert kept["cam2"] >= 10
    assert 4 <= len(first) <= kept["cam2"], "the last ones were not on disk"
    assert_same_film(first, played[: len(first)])
    assert_same_film(second, played[-len(second) :])
    assert any("the viewer of cam2 was started again" in line for line in facts["warnings"])
    clip = open_clip(Settings(clip=str(tmp_path / "pictures")))
    assert len(clip.views[1].capture_s) == kept["cam2"]
