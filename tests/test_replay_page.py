"""A recorded run on the live page: what a browser is told of it, and that it is played there."""

import io
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from rich.console import Console

from runtime.live.free_ports import free_port

pytest.importorskip("mcap", reason="pip install 'tritrack[mcap]'")
pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from browser import open_tab
from staging import RIG
from test_live import CHROMIUM, SIZES, SOFT, Looking, told
from test_replaying import body_at, made_up, run, said_at

from animator.page.live import LivePage
from animator.scene import Snapshot
from common.bus.control_messages import Cameras
from common.bus.messages import Body, Performance, Posture
from common.rig.camera import Rig
from runtime.store.past_run import open_run
from runtime.store.recording import read_recording
from tritrack import replay_page
from tritrack.replay_page import show

__all__ = ["run"]


@pytest.fixture
def page() -> Iterator[LivePage]:
    one = LivePage("a recording", free_port(), commands=False)
    yield one
    one.close()


@pytest.mark.slow
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


class Shown:
    """A page that keeps what it is told."""

    def __init__(self) -> None:
        self.said: list[Any] = []

    def set_rig(self, rig: Rig) -> None:
        self.said.append(rig)

    def show(self, snapshot: Snapshot, ended: list[Posture]) -> None:
        seen = sorted(snapshot.reports)
        told = (snapshot.body and snapshot.body.captured_s, seen, snapshot.performed)
        events = tuple(posture.event for posture in ended)
        self.said.append((*told, snapshot.posture and snapshot.posture.name, events))


def test_each_body_is_shown_in_its_own_rig_with_what_was_performed_until_then() -> None:
    """The second rig is told once, with the first body that it tells of; where none is known the
    page draws no room."""
    first = msgspec.structs.replace(RIG, width=320)
    second = msgspec.structs.replace(RIG, width=640)
    squat = Performance(name="squat", onset=0, end=1, onset_s=0.0, end_s=0.1, posterior=0.9)

    def posture(at_s: float, event: Performance | None) -> Posture:
        return Posture(frame=0, captured_s=at_s, clock_s=at_s, name="kick", event=event)

    recording = made_up(
        [said_at(1, 0, 0.0), said_at(1, 3, 0.3)],
        [said_at(2, 1, 0.1), said_at(2, 3, 0.3)],
        [
            *(body_at(0.0, (0, -1)), body_at(0.1, (-1, 1)), body_at(0.2, (-1, -1), calibration=1)),
            *(body_at(0.3, (3, 3), calibration=1), body_at(0.4, (9, 9), calibration=1)),
        ],
        [Cameras(rig=second, scale_source="person", calibration=1)],
    )
    recording = recording._replace(postures=[posture(0.1, squat), posture(0.3, None)])
    page = Shown()
    assert show(page, recording) == 5  # type: ignore[arg-type]
    shown: list[Any] = [
        (0.0, [1], "", None, ()),
        (0.1, [2], "squat", "kick", (squat,)),
        second,
        (0.2, [], "squat", None, ()),
        (0.3, [1, 2], "squat", "kick", ()),
        (0.4, [], "squat", None, ()),
    ]
    assert page.said == shown
    page = Shown()
    known = recording._replace(head=msgspec.structs.replace(recording.head, rig=first))
    show(page, known)  # type: ignore[arg-type]
    assert page.said == [first, *shown]


def test_the_bodies_of_an_instant_are_one_frame_with_a_posture_for_each() -> None:
    squat = Performance(name="squat", onset=0, end=1, onset_s=0.0, end_s=0.1, posterior=0.9)

    def posture(person: int, event: Performance | None = None) -> Posture:
        return Posture(
            person=person, frame=0, captured_s=0.1, clock_s=0.1, name=f"of {person}", event=event
        )

    def person(number: int, made_of: tuple[int, int], at_s: float = 0.1) -> Body:
        return msgspec.structs.replace(body_at(at_s, made_of), person=number)

    recording = made_up(
        [said_at(1, 1, 0.1), said_at(1, 2, 0.2)],
        [said_at(2, 1, 0.1), said_at(2, 2, 0.2)],
        [person(2, (-1, 1)), person(1, (1, -1)), person(2, (2, 2), 0.2)],
        [],
    )
    recording = recording._replace(postures=[posture(1), posture(2, squat)])
    shown: list[Snapshot] = []
    ended: list[list[tuple[int, Any]]] = []

    class Kept(Shown):
        def show(self, snapshot: Snapshot, postures: list[Posture]) -> None:
            shown.append(snapshot)
            ended.append([(posture.person, posture.event) for posture in postures])

    assert show(Kept(), recording) == 2  # type: ignore[arg-type]
    first, second = shown
    assert first.body is not None
    assert first.posture is not None
    assert (first.body.person, first.posture.name, sorted(first.reports)) == (1, "of 1", [1, 2])
    (other,) = first.others
    assert (other.body.person, other.posture, other.performed) == (2, posture(2, squat), "squat")
    assert ended == [[(2, squat)], []]
    assert second.body is not None
    assert (second.body.person, second.posture, second.performed) == (2, None, "squat")


def test_a_recording_is_played_until_ctrl_c_and_its_page_closed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[Any] = []
    page = SimpleNamespace(
        address="http://127.0.0.1:9",
        end=lambda facts: asked.append(("end", facts)),
        close=lambda: asked.append("close"),
    )
    stop = SimpleNamespace(wait=lambda: asked.append("wait"))

    def opened(*given: Any, **more: Any) -> Any:
        asked.append((given, more))
        return page

    place = "tritrack.replay_page"
    recording = made_up([], [], [], [])
    monkeypatch.setattr(f"{place}.read_recording", lambda _: recording)
    monkeypatch.setattr(
        f"{place}.open_run", lambda folder: SimpleNamespace(summary={"of": folder.name})
    )
    monkeypatch.setattr(f"{place}.process", lambda *_: nullcontext(stop))
    monkeypatch.setattr(f"{place}.LivePage", opened)
    monkeypatch.setattr(f"{place}.show", lambda *_: 7)
    said = Console(file=io.StringIO(), width=200)
    names = tuple(f"camera {number}" for number in range(1, 9))
    told = replay_page.replay_on_page(tmp_path / "walk", 9, said)
    assert told == {"clip": "made up", "shown": 7}
    assert asked == [
        (
            ("made up", 9),
            {"commands": False, "cameras": names, "most_bytes": 160_000_000},
        ),
        ("end", {"of": "walk", "out": str(tmp_path / "walk")}),
        "wait",
        "close",
    ]
    assert isinstance(said.file, io.StringIO)
    assert said.file.getvalue() == "the page is at http://127.0.0.1:9; Ctrl-C ends it\n"
