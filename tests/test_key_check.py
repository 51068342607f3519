"""Keys looked over: each planted fault is named, with its cure."""

import re
import shutil
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("cryptography", reason="keys are an extra: install tritrack[keys]")

from runtime.keys.authority import make_keys
from tritrack.doctor.installation import Finding
from tritrack.doctor.key_check import _dated, examine_keys

DAYS = 30


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    make_keys(folder, ["rig.local"], DAYS)
    make_keys(folder / "foreign", [], DAYS)
    return folder


@pytest.fixture
def keys(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "keys"))


def faults(folder: Path, later: timedelta = timedelta()) -> dict[str, Finding]:
    found = examine_keys(folder, datetime.now(UTC) + later)
    return {one.what: one for one in found if not one.ok and one.needed}


def test_new_keys_are_sound_and_tell_until_when_and_for_which_hosts(keys: Path) -> None:
    found = {one.what: one for one in examine_keys(keys)}
    assert all(one.ok for one in found.values())
    assert len(found) == 15
    assert "rig.local" in found["keys: integrator"].detail
    assert f"{datetime.now(UTC) + timedelta(days=DAYS):%Y-%m-%d}" in found["keys: client"].detail


def test_a_host_needs_its_own_parts_alone(keys: Path) -> None:
    for path in keys.iterdir():
        if path.name not in ("ca.pem", "viewer1.pem", "viewer1.key"):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    assert faults(keys) == {}
    absent = [one for one in examine_keys(keys) if one.detail == "not here"]
    assert len(absent) == 13


@pytest.mark.parametrize(
    ("days", "says"), [(DAYS - 13, "expires on"), (DAYS + 1, "expired on"), (-1, "yet to come")]
)
def test_the_date_is_held_against_the_clock(keys: Path, days: int, says: str) -> None:
    found = faults(keys, timedelta(days=days))
    assert len(found) == 15
    assert all(says in one.detail for one in found.values())
    assert all(("--force" in one.cure) is (days > 0) for one in found.values())


def test_two_weeks_and_a_day_before_the_end_all_is_well(keys: Path) -> None:
    assert faults(keys, timedelta(days=DAYS - 15)) == {}


@pytest.mark.parametrize(
    ("now", "says"),
    [
        ((2026, 1, 1), "holds from 2026-01-02 03:04 UTC on, which is yet to come"),
        ((2026, 2, 1), "until 2026-03-05 16:47 UTC"),
        ((2026, 3, 1), "expires on 2026-03-05 16:47 UTC"),
        ((2026, 3, 6), "expired on 2026-03-05 16:47 UTC"),
    ],
)
def test_a_date_is_said_to_the_minute(now: tuple[int, int, int], says: str) -> None:
    begins = datetime(2026, 1, 2, 3, 4, tzinfo=UTC)
    ends = datetime(2026, 3, 5, 16, 47, tzinfo=UTC)
    held: Any = SimpleNamespace(not_valid_before_utc=begins, not_valid_after_utc=ends)
    assert _dated("client", held, datetime(*now, tzinfo=UTC)).detail == says


def lose_key(keys: Path) -> None:
    (keys / "viewer1.key").unlink()


def open_key(keys: Path) -> None:
    (keys / "viewer1.key").chmod(0o640)


def take_anothers_key(keys: Path) -> None:
    shutil.copy(keys / "viewer2.key", keys / "viewer1.key")


def take_anothers_certificate(keys: Path) -> None:
    for kind in ("pem", "key"):
        shutil.copy(keys / f"viewer2.{kind}", keys / f"viewer1.{kind}")


def take_foreign(keys: Path) -> None:
    for kind in ("pem", "key"):
        shutil.copy(keys / "foreign" / f"viewer1.{kind}", keys / f"viewer1.{kind}")


def spoil(keys: Path) -> None:
    (keys / "viewer1.pem").write_text("-----BEGIN CERTIFICATE-----\nAAAA\n")


@pytest.mark.parametrize(
    ("harm", "says"),
    [
        (lose_key, "cannot read .*viewer1.key: no such file"),
        (open_key, "viewer1.key is readable by others .mode 640"),
        (take_anothers_key, "viewer1.key is not the key of .*viewer1.pem"),
        (take_anothers_certificate, "viewer1.pem is of CN=viewer2"),
        (take_foreign, "viewer1.pem is not signed by .*ca.pem"),
        (spoil, "viewer1.pem holds no certificate"),
    ],
)
def test_a_fault_is_named_where_it_is_and_only_there(
    keys: Path, harm: Callable[[Path], None], says: str
) -> None:
    harm(keys)
    (found,) = faults(keys).values()
    assert found.what == "keys: viewer1"
    assert re.search(says, found.detail)
    assert found.cure


@pytest.mark.parametrize("what", ["no folder", "an empty folder", "an authority alone"])
def test_a_folder_without_keys_is_named(keys: Path, tmp_path: Path, what: str) -> None:
    folder = tmp_path / "other"
    if what != "no folder":
        folder.mkdir()
    if what == "an authority alone":
        shutil.copy(keys / "ca.pem", folder)
    (found,) = faults(folder).values()
    assert str(folder) in found.detail
    assert "tritrack keys" in found.cure


def test_an_authority_that_is_missing_or_none_is_named_first_and_alone(keys: Path) -> None:
    path = keys / "ca.pem"
    path.write_text("no certificate")
    (found,) = examine_keys(keys)
    assert (found.what, found.ok) == ("keys: ca.pem", False)
    assert found.detail == f"{path} holds no certificate or key"
    path.unlink()
    (found,) = examine_keys(keys)
    assert found.detail == f"cannot read {path}: no such file or directory"


def test_a_folder_of_the_authority_alone_has_no_parts_keys(keys: Path) -> None:
    for path in keys.iterdir():
        if path.name != "ca.pem":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    authority, missing = examine_keys(keys)
    assert (authority.what, authority.ok) == ("keys: ca.pem", True)
    assert (missing.what, missing.ok, missing.detail) == (
        "keys",
        False,
        f"no part's keys in {keys}",
    )
