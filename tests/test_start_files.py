"""The files beside the runs: placed for a job, cleaned, deleted; and what may be served of them."""

import json
import os
import shutil
from pathlib import Path

import pytest

from runtime.store.other_run import RUN_OF
from tritrack.starting.job_plan import Plan, PlanError
from tritrack.starting.start_files import clean, delete_run, place, served


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """A run with its own video, one of which there is none any more, a calibration, a secret."""
    folder = tmp_path / "runs"
    for path in ("walk/poses.npz", "walk/summary.json", "walk/poses.csv", "walk/log.txt"):
        written(folder / path)
    for path in (".clips/walk/walk.avi", ".clips/gone/gone.avi", ".settings/live_1.toml"):
        written(folder / path)
    written(folder / ".calibrations/room.json")
    written(folder / ".calibrations/room.txt")
    written(tmp_path / "secret.csv")
    return folder


def written(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(path.name.encode())
    return path


def got(runs: Path, path: str) -> bytes | None:
    found = served(path, runs, {"walk": b"jpeg"}, {"video0": b"frame"}.get)
    return None if found is None else found.content


def test_what_is_offered_is_served(runs: Path) -> None:
    assert got(runs, "/run/walk/poses.csv") == b"poses.csv"
    assert got(runs, "/run/walk/picture.jpg") == b"jpeg"
    assert got(runs, "/calibration/room.json") == b"room.json"
    assert got(runs, "/camera/video0.jpg") == b"frame"
    written(runs / "a run ü/poses.npz")
    assert got(runs, "/run/a%20run%20%C3%BC/poses.npz") == b"poses.npz"
    written(runs / os.fsdecode(b"caf\xe9/poses.npz"))
    assert got(runs, "/run/caf%E9/poses.npz") == b"poses.npz"
    written(runs / "walk/body_person2.bvh")
    assert got(runs, "/run/walk/body_person2.bvh") == b"body_person2.bvh"


def test_a_report_is_shown_without_a_script_and_the_rest_is_only_loaded(runs: Path) -> None:
    written(runs / "walk/report.html")
    shown = served("/run/walk/report.html", runs, {}, lambda _: None)
    assert shown is not None
    assert shown.kind == "text/html"
    assert "script-src" not in shown.policy
    assert "default-src 'none'" in shown.policy
    loaded = served("/run/walk/poses.csv", runs, {}, lambda _: None)
    assert loaded is not None
    assert loaded.kind == "application/octet-stream"


@pytest.mark.parametrize(
    "path",
    [
        *("/run/walk/../secret.csv", "/run/../secret.csv", "/run/%2e%2e/secret.csv"),
        *("/run/walk/..%2F..%2Fsecret.csv", "/run/..%2Fsecret.csv", "/run//poses.csv"),
        *("/run/.clips/walk", "/run/.clips%2Fwalk/walk.avi", "/run/.calibrations/room.json"),
        *("/run/walk/log.txt", "/run/walk/", "/run/walk", "/run/other/picture.jpg"),
        *("/calibration/room.txt", "/calibration/../walk/poses.csv", "/calibration/.json"),
        *("/calibration/..%2Fwalk%2Fposes.csv", "/camera/video1.jpg", "/", "", "/run"),
        *("/run/walk/poses.csv/", "/run/walk/poses.csv%00", "/run/linked/poses.csv"),
        *("/calibration/linked.json", "/calibration/plain", f"/run/{'a' * 300}/poses.csv"),
    ],
)
def test_nothing_else_is(runs: Path, path: str) -> None:
    (runs / "linked").symlink_to(runs / "walk")
    (runs / ".calibrations/linked.json").symlink_to(runs.parent / "secret.csv")
    written(runs / ".calibrations/plain")
    assert got(runs, path) is None


def test_a_link_in_a_run_leads_nowhere(runs: Path) -> None:
    (runs / "walk/markers.trc").symlink_to(runs.parent / "secret.csv")
    assert got(runs, "/run/walk/markers.trc") is None


def test_a_job_reads_links_and_the_tray_keeps_its_files(runs: Path, tmp_path: Path) -> None:
    source, target = written(tmp_path / "up/1/cam.avi"), runs / ".clips/new/new.avi"
    plan = Plan("new", (), ((source, target),), report=runs / ".calibrations/new.txt")
    place(plan)
    place(plan)
    assert target.samefile(source)
    source.unlink()
    assert target.read_bytes() == b"cam.avi"
    with pytest.raises(PlanError, match="drop the files again"):
        place(plan)


def test_what_belongs_to_no_run_is_cleaned(runs: Path) -> None:
    clean(runs, lambda path: path == runs / ".settings/live_1.toml")
    left = {path.relative_to(runs).as_posix() for path in runs.glob(".*/*")}
    assert left == {
        *(".clips/walk", ".settings/live_1.toml"),
        *(".calibrations/room.json", ".calibrations/room.txt"),
    }


def test_a_run_is_deleted_with_its_own_videos_and_nothing_else(runs: Path) -> None:
    assert delete_run(runs, "walk")
    assert not (runs / "walk").exists()
    assert (runs / ".clips/gone").exists()
    clean(runs, lambda path: path.name == "gone")
    assert not (runs / ".clips/walk").exists()
    assert (runs / ".clips/gone").exists()


def test_a_run_renamed_or_copied_by_hand_keeps_its_videos_until_the_last_is_deleted(
    runs: Path,
) -> None:
    made_of = {"command": "single", "footage": [str(runs / ".clips/walk/walk.avi")]}
    (runs / "walk/summary.json").write_text(json.dumps({RUN_OF: made_of}))
    shutil.copytree(runs / "walk", runs / "copy")
    (runs / "walk").rename(runs / "my best walk")
    for name in ("my best walk", "copy"):
        clean(runs, lambda _: False)
        assert (runs / ".clips/walk/walk.avi").is_file()
        assert delete_run(runs, name)
    clean(runs, lambda _: False)
    assert not (runs / ".clips/walk").exists()


@pytest.mark.parametrize("name", ["", ".", "..", ".clips", "../runs", "walk/..", "other", "linked"])
def test_what_is_no_run_is_not_deleted(runs: Path, name: str) -> None:
    (runs / "linked").symlink_to(runs / "walk")
    before = sorted(runs.parent.rglob("*"))
    assert not delete_run(runs, name)
    assert sorted(runs.parent.rglob("*")) == before


def test_a_run_of_which_something_is_left_is_not_said_to_be_deleted(
    runs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where a file in it is another user's."""
    monkeypatch.setattr(shutil, "rmtree", lambda path, ignore_errors: None)
    with pytest.raises(PlanError, match="walk is left: see that you may write it"):
        delete_run(runs, "walk")


def test_a_renamed_run_keeps_its_videos_where_the_folder_is_reached_by_a_link_or_was_moved(
    runs: Path,
) -> None:
    """Commands write where their videos are, whichever way led there."""
    made_of = {"command": "single", "footage": [str(runs / ".clips/walk/walk.avi")]}
    (runs / "walk/summary.json").write_text(json.dumps({RUN_OF: made_of}))
    (runs / "walk").rename(runs / "best")
    link = runs.parent / "link"
    link.symlink_to(runs)
    clean(link, lambda _: False)
    assert (runs / ".clips/walk/walk.avi").is_file()
    link.unlink()
    clean(runs.rename(runs.parent / "moved"), lambda _: False)
    assert (runs.parent / "moved/.clips/walk/walk.avi").is_file()
