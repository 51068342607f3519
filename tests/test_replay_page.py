"""A recorded run on the live page: what a browser is told of it, and that it is played there."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mcap", reason="pip install 'tritrack[mcap]'")
pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab
from test_live import CHROMIUM, SIZES, SOFT, Looking, told
from test_page_server import free_port
from test_replaying import run

from animator.page.live import LivePage
from tritrack.replay_page import show
from tritrack.store.past_run import open_run
from tritrack.store.recording import read_recording

__all__ = ["run"]


@pytest.fixture
def page() -> Iterator[LivePage]:
    one = LivePage("a recording", free_port(), commands=False)
    yield one
    one.close()


def test_each_body_is_told_with_its_outlines_and_its_joints(run: Path, page: LivePage) -> None:
    """What is told is what the run folder holds."""
    poses = open_run(run).poses
    assert show(page, read_recording(run)) == len(poses["frame"])
    page.end({"clip": "walk"})
    heard = told(page, len(poses["frame"]) + 3)
    frames = [each for each in heard if each["kind"] == "frame"]
    assert heard[-1]["kind"] == "over"
    assert [each["frame"] for each in frames] == poses["frame"].tolist()
    posed = np.array(np.isfinite(poses["joints_px"][:, 0]).all(axis=(1, 2))).tolist()
    for each, joints_px, is_posed in zip(frames, poses["joints_px"][:, 0], posed, strict=True):
        view = each["views"][0]
        assert bool(view["joints"]) == is_posed
        if is_posed:
            assert np.array(view["joints"][:30]).reshape(15, 2) == pytest.approx(joints_px, abs=0.1)
            assert view["outline"], "somebody is seen, so there is an outline"


def test_bodies_whose_reports_were_lost_are_shown_without_outlines(
    run: Path, page: LivePage
) -> None:
    recording = read_recording(run)
    at = len(recording.bodies) // 2
    recording.reports[0].pop(at)
    recording.reports[1].pop(at)
    assert show(page, recording) == len(recording.bodies)


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: the page is not looked at")
def test_a_browser_plays_it_from_its_begin_to_its_end(run: Path, page: LivePage) -> None:
    count = show(page, read_recording(run))
    page.end({"clip": "walk"})
    last = read_recording(run).bodies[-1].frame
    with open_tab(str(CHROMIUM), SOFT) as tab:
        looking = Looking(tab, page.address, SIZES["desk"])
        assert looking.until(f"document.body.dataset.frame === '{last}'")
        assert looking.ask("document.querySelector('#scrub').max") == str(count - 1)
        assert looking.ask("document.querySelector('#health').hidden"), "it has no processes"
        looking.key("Home", 36)
        assert looking.until(f"document.body.dataset.frame !== '{last}'")
        looking.key(" ", 32)
        assert looking.until(f"document.body.dataset.frame === '{last}'"), "it does not play"
