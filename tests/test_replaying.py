"""Replay: recorded reports give the same bodies byte for byte, offline and live."""

import json
import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest
from local_bus import LocalBus
from rich.console import Console

from common.bus.control_messages import Cameras
from common.bus.messages import Body, Message, Posture, Report, ViewerNumber
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from tritrack.live.free_ports import free_settings
from tritrack.live.session import live
from tritrack.offline.batch import Asked, track_all
from tritrack.replaying import pairs, replay_run, say
from tritrack.store.other_run import OtherRun, run_of
from tritrack.store.past_run import open_run
from tritrack.store.recording import read_recording
from tritrack.store.runs import write_run

pytest.importorskip("mcap", reason="pip install 'tritrack[mcap]'")

QUIET = Console(quiet=True)


@pytest.fixture(scope="module")
def run(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("recorded")
    track_all([clip], out, Asked(record=True), QUIET)
    return out / clip.name


def test_recorded_reports_give_the_same_bodies_byte_for_byte(run: Path, tmp_path: Path) -> None:
    facts = replay_run(run, tmp_path / "again")
    before, again = open_run(run).poses, open_run(tmp_path / "again").poses
    assert facts["same"] == facts["bodies"] == len(before["frame"]) > 0
    assert np.array_equal(before["joints_m"], again["joints_m"], equal_nan=True)


def test_what_is_replayed_takes_the_place_of_another_run_only_by_force(
    run: Path, tmp_path: Path
) -> None:
    write_run(tmp_path, [], Settings(), run_of("single", ["dance.avi"]).facts)
    before = (tmp_path / "poses.npz").read_bytes()
    with pytest.raises(OtherRun, match=r"run \(tritrack single of .*dance.avi\): .*--force"):
        replay_run(run, tmp_path)
    with pytest.raises(OtherRun, match="another run"):
        replay_run(run, run)
    assert (tmp_path / "poses.npz").read_bytes() == before
    for force in (True, False):
        replay_run(run, tmp_path, force)
    assert (tmp_path / "poses.npz").read_bytes() != before


@pytest.mark.parametrize("views", [(1,), (2,)])
def test_a_run_of_one_view_comes_back_too(
    clip: Path, tmp_path: Path, views: tuple[ViewerNumber, ...]
) -> None:
    track_all([clip], tmp_path, Asked(views=views, record=True), QUIET)
    facts = replay_run(tmp_path / clip.name, None)
    assert facts["same"] == facts["bodies"] > 0


def test_a_body_whose_reports_were_lost_is_left_out(run: Path) -> None:
    recording = read_recording(run)
    recording.reports[0].pop(3)
    recording.reports[1].pop(3)
    made_of = list(pairs(recording))
    assert len(made_of) == len(recording.bodies) - 1
    assert all(body.captured_s == pair.newest.captured_s for body, pair in made_of)


def test_a_body_of_one_view_is_made_of_that_view_again_whatever_came_too_late(run: Path) -> None:
    recording = read_recording(run)
    for n, alone in ((3, (3, -1)), (5, (-1, 5))):
        assert recording.bodies[n].made_of == (n, n)
        recording.bodies[n] = msgspec.structs.replace(recording.bodies[n], made_of=alone)
    made_of = [pair for _, pair in pairs(recording)]
    assert made_of[3].second is None
    assert made_of[5].first is None
    assert len(made_of) == len(recording.bodies)


def test_all_that_was_said_is_said_again_in_its_order(run: Path) -> None:
    recording, bus = read_recording(run), LocalBus()
    few = recording._replace(reports=tuple(each[:9] for each in recording.reports))  # type: ignore[arg-type]
    few = few._replace(bodies=recording.bodies[:9])
    reports, bodies, postures = (bus.subscribe(kind) for kind in (Report, Body, Posture))
    assert say(few, bus, speed=50.0) == 28
    heard = bodies.drain()
    assert [msgspec.structs.replace(b, clock_s=0.0) for b in heard] == [
        msgspec.structs.replace(b, clock_s=0.0) for b in few.bodies
    ]
    assert [getattr(r, "viewer", 0) for r in reports.drain()] == [1, 2] * 9
    assert postures.drain() == []


def test_the_rig_of_a_recording_is_said_before_the_bodies_that_it_tells(run: Path) -> None:
    """One that was known before the run, which the page waits for, and one that is found later."""
    recording, bus = read_recording(run), InOrder()
    assert recording.head.rig is not None
    before, after = recording.bodies[:4], recording.bodies[4:8]
    after = [msgspec.structs.replace(body, calibration=1) for body in after]
    later = Cameras(rig=recording.head.rig, scale_source="person", calibration=1)
    say(
        recording._replace(reports=([], []), bodies=[*before, *after], cameras=[later]),
        bus,
        speed=50.0,
    )
    told = [type(said).__name__ for said in bus.said if isinstance(said, Cameras | Body)]
    assert told == ["Cameras", *["Body"] * 4, "Cameras", *["Body"] * 4]
    rigs = [said for said in bus.said if isinstance(said, Cameras)]
    assert [rig.scale_source for rig in rigs] == ["calibrated", "person"]


class InOrder(LocalBus):
    """All that is said on it."""

    def __init__(self) -> None:
        super().__init__()
        self.said: list[Message] = []

    def publish(self, message: Message) -> None:
        """Keep it too."""
        self.said.append(message)
        super().publish(message)


@pytest.mark.slow
def test_a_live_run_comes_back_byte_for_byte(clip: Path, tmp_path: Path) -> None:
    """Also what two processes reported, paired by the integrator as they came."""
    slow = tmp_path / clip.name
    shutil.copytree(clip, slow)
    shutil.copy(clip.parent / "calibration.json", slow)
    meta = json.loads((slow / "meta.json").read_text())
    (slow / "meta.json").write_text(json.dumps({**meta, "fps": 5}))
    settings = free_settings(Settings(clip=str(slow), page=PageSettings(port=0)))
    live(settings, tmp_path / "lived", QUIET, record=True)
    facts = replay_run(tmp_path / "lived", None)
    assert facts["same"] == facts["bodies"] == len(open_run(tmp_path / "lived").poses["frame"])
