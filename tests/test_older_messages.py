"""Runs, recordings and settings that version 0.2.0 wrote, read by this one.

`data/run_0_2` is what its `tritrack track small.toml --out . --record` made of a clip of its own
`tritrack synth --seed 4242 --posture kick_right_forward --size 160x120`; small.toml is
`data/settings_0_2.toml` with `every = 4` and `size = "80x60"`.
"""

import csv
import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest

from common.bus.message_codec import MalformedMessage, encode
from common.bus.messages import Body
from common.config.config_file import load
from common.config.renamed_settings import RenamedSetting, settings_of
from lab.accuracy.tracking_evaluation import _case
from runtime.store.journal import HEAD, NAME, framed
from runtime.store.older_messages import read_message
from runtime.store.past_run import open_run
from runtime.store.recording import read_recording
from tritrack.exporting import export_run
from tritrack.replay_page import show
from tritrack.replaying import integrated, replay_run

DATA = Path(__file__).parent / "data"
RUN = DATA / "run_0_2"
FRAMES = 18
EMPTY = 3
"""Its first frames show no person."""


def test_its_settings_are_read_with_a_word_on_each_camera() -> None:
    with pytest.warns(RenamedSetting, match=r"\[cameras\.cam[12]\]") as told:
        settings = load(DATA / "settings_0_2.toml")
    assert len(told) == 2
    assert [*settings.cameras] == ["cam1", "cam2"]
    assert settings.cameras["cam2"].source.endswith("kick_right_forward/cam2.avi")


def test_its_run_is_read_as_one_of_a_person_and_two_cameras() -> None:
    run = open_run(RUN)
    before = np.load(RUN / "poses.npz")
    assert run.poses["person"].tolist() == [0] * FRAMES
    assert run.poses["camera_names"].tolist() == ["cam1", "cam2"]
    assert run.poses["seen"].tolist() == [[False] * 2] * EMPTY + [[True] * 2] * (FRAMES - EMPTY)
    assert run.poses["views"].tolist() == before["views"].tolist()
    assert np.array_equal(run.poses["joints_px"], before["joints_px"][:, :, :15], equal_nan=True)
    assert [*settings_of(run.summary["settings"]).cameras] == ["cam1", "cam2"]


@pytest.mark.parametrize(
    ("word", "seen"),
    [("both", [True, True]), ("1", [True, False]), ("2", [False, True]), ("none", [False, False])],
)
def test_its_word_for_who_sees_the_person_is_told_by_camera(
    tmp_path: Path, word: str, seen: list[bool]
) -> None:
    arrays = dict(np.load(RUN / "poses.npz"))
    arrays["views"] = np.full(FRAMES, word)
    shutil.copy(RUN / "summary.json", tmp_path)
    np.savez(tmp_path / "poses.npz", **arrays)
    assert open_run(tmp_path).poses["seen"].tolist() == [seen] * FRAMES


def test_its_run_is_exported_with_the_cameras_names(tmp_path: Path) -> None:
    export_run(RUN, "csv", tmp_path / "kick.csv")
    with (tmp_path / "kick.csv").open() as file:
        rows = [*csv.DictReader(file)]
    assert [(row["person"], row["seen_cam1"], row["seen_cam2"]) for row in rows[EMPTY - 1 : 4]] == [
        ("0", "0", "0"),
        ("0", "1", "1"),
    ]


def test_its_recording_gives_the_bodies_that_it_recorded_bit_for_bit() -> None:
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")
    recording = read_recording(RUN)
    assert [len(reports) for reports in recording.reports] == [FRAMES, FRAMES, *[0] * 6]
    done = integrated(recording)
    assert (len(done.bodies), done.same) == (FRAMES, FRAMES)


def test_a_run_that_is_made_of_its_recording_is_one_of_this_version(tmp_path: Path) -> None:
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")
    replay_run(RUN, tmp_path / "again")
    with np.load(RUN / "poses.npz") as before, np.load(tmp_path / "again" / "poses.npz") as now:
        assert {*now.files} - {*before.files} == {"person", "camera_names", "seen"}
        differ = [name for name in before.files if before[name].tobytes() != now[name].tobytes()]
    assert differ == []


def test_its_journal_is_read_where_the_run_was_cut_short(tmp_path: Path) -> None:
    """A record of 0.2: the head with its two cameras, and a body without `seen`."""
    told = {"settings": {"clip": "walk", "camera_1": {"device": 3}}, "facts": {}, "protocol": 11}
    body = msgspec.msgpack.decode(
        encode(Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="2"))
    )
    del body["seen"]
    old = framed(b"b", msgspec.msgpack.encode({**body, "protocol": 11}))
    (tmp_path / NAME).write_bytes(framed(HEAD, msgspec.msgpack.encode(told)) + old)
    run = open_run(tmp_path)
    assert run.poses["seen"].tolist() == [[False, True]]
    assert run.summary["settings"]["cameras"]["cam1"]["device"] == 3


def test_a_message_of_another_protocol_is_refused() -> None:
    body = Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")
    for protocol in (10, 99):
        with pytest.raises(MalformedMessage, match=f"protocol {protocol}"):
            read_message(encode(msgspec.structs.replace(body, protocol=protocol)), Body)


def test_the_page_plays_its_recording() -> None:
    pytest.importorskip("mcap", reason="recordings are an extra: install tritrack[mcap]")

    class Page:
        def __init__(self) -> None:
            self.shown = 0

        def set_rig(self, rig: object) -> None:
            assert rig is not None

        def show(self, snapshot: object, event: object) -> None:
            self.shown += 1

    page = Page()
    assert show(page, read_recording(RUN)) == page.shown == FRAMES  # type: ignore[arg-type]


def test_its_run_is_evaluated_against_a_truth(tmp_path: Path) -> None:
    """A truth 100 mm above what it tracked, every fourth frame of the clip."""
    with np.load(RUN / "poses.npz") as poses:
        joints_m = np.full((69, *poses["joints_m"].shape[1:]), np.nan)
        joints_m[::4] = poses["joints_m"] + (0.0, 0.1, 0.0)
        names = poses["joint_names"]
    present = np.isfinite(joints_m).all(axis=(1, 2))
    np.savez(tmp_path / "truth.npz", present=present, joints3d=joints_m, joint_names=names)
    case = _case(RUN, tmp_path, None, None)
    assert case.settings.mode == "default"
    assert len(case.compared.frames) == FRAMES - EMPTY
    assert case.compared.off_mm == pytest.approx(100.0)
