"""A bus with keys over real sessions on the loopback: who gets in."""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import zenoh
from keyring import foreign, tls_as, with_keys
from meeting import a_body, free_endpoint
from moving import random_joints

pytest.importorskip("cryptography", reason="keys are an extra: install tritrack[keys]")

from common.bus.bus import BusError, open_client, open_hub
from common.bus.bus_keys import HUB, PARTS, KeysError, Part, refuse_missing, tls_of
from common.bus.inbox import Alive
from common.bus.messages import Body
from common.config.part_settings import BusSettings
from runtime.keys.authority import make_keys
from tritrack import subscribe

ROOM = "room"
SOON_S = 5.0
NEVER_S = 0.5
"""Patience with who must not get in: those that may need a hundredth of it."""


@pytest.fixture
def settings(keys: Path) -> Iterator[BusSettings]:
    place = with_keys(keys)
    with open_hub(place, ROOM):
        yield place


@pytest.mark.parametrize("part", [part for part in PARTS if part not in (HUB, "client")])
def test_each_part_gets_in_with_its_keys(settings: BusSettings, part: Part) -> None:
    with open_client(settings, ROOM, SOON_S, part):
        pass


def test_without_a_certificate_nobody_gets_in(settings: BusSettings, keys: Path) -> None:
    """Neither by TLS, knowing the authority, nor by plain TCP on the same port."""
    place = {"connect": settings.endpoint}
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        foreign("client", place, {"root_ca_certificate": str(keys / "ca.pem")})
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        foreign("client", {"connect": settings.endpoint.replace("tls/", "tcp/")}, {})


def test_the_integrators_own_certificate_opens_nothing_for_who_connects(
    settings: BusSettings, keys: Path
) -> None:
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        foreign("client", {"connect": settings.endpoint}, tls_as(keys, "integrator"))


def test_with_keys_of_another_authority_nobody_gets_in(
    settings: BusSettings, tmp_path: Path
) -> None:
    make_keys(tmp_path, [], 2)
    theirs = with_keys(tmp_path, settings.endpoint)
    with (
        pytest.raises(BusError, match=f"look at the keys: tritrack doctor --keys {tmp_path}"),
        open_client(theirs, ROOM, NEVER_S, "viewer1"),
    ):
        pass


def test_with_keys_of_another_authority_that_trusts_ours_nobody_gets_in(
    settings: BusSettings, keys: Path, tmp_path: Path
) -> None:
    """What the hub checks, not only what a client does."""
    make_keys(tmp_path, [], 2)
    (tmp_path / "ca.pem").write_bytes((keys / "ca.pem").read_bytes())
    with (
        pytest.raises(BusError, match="nobody answers"),
        open_client(with_keys(tmp_path, settings.endpoint), ROOM, NEVER_S),
    ):
        pass


def test_expired_keys_open_nothing(tmp_path: Path) -> None:
    make_keys(tmp_path, [], 0)
    time.sleep(1.1)  # dates are whole seconds
    expired = with_keys(tmp_path)
    with (
        open_hub(expired, ROOM),
        pytest.raises(BusError, match="nobody answers"),
        open_client(expired, ROOM, NEVER_S),
    ):
        pass


def test_who_holds_a_clients_keys_cannot_pose_as_the_integrator(keys: Path) -> None:
    place = with_keys(keys)
    false = tls_as(keys, "client", "listen")
    with (
        foreign("router", {"listen": place.endpoint}, false),
        pytest.raises(BusError, match="nobody answers"),
        open_client(place, ROOM, NEVER_S, "viewer1"),
    ):
        pass


def test_a_part_finds_an_integrator_that_was_started_again(keys: Path) -> None:
    place = with_keys(keys)
    with ExitStack() as doors:
        with open_hub(place, ROOM):
            viewer = doors.enter_context(open_client(place, ROOM, SOON_S, "viewer1"))
            viewer.announce("viewer 1")
        with open_hub(place, ROOM) as hub:
            assert hub.watch_alive().take(SOON_S) == Alive("viewer 1", alive=True)


def test_a_program_with_a_clients_keys_hears_the_bodies(keys: Path) -> None:
    place = with_keys(keys)
    heard: list[Body] = []
    with ExitStack() as doors:
        hub = doors.enter_context(open_hub(place, ROOM))
        hub.announce("integrator")
        ears = doors.enter_context(open_client(place, ROOM, SOON_S)).subscribe(Body)
        until_s = time.monotonic() + SOON_S
        while not heard and time.monotonic() < until_s:
            hub.publish(a_body(7, random_joints(1)[0]))
            heard += [body] if (body := ears.take(0.05)) else []
    assert heard
    assert heard[0].frame == 7
    with pytest.raises(BusError):
        next(iter(subscribe(place.endpoint, keys=str(keys), wait_s=0.2)))


@pytest.mark.parametrize("name", ["ca.pem", "viewer1.pem", "viewer1.key"])
def test_a_file_that_is_missing_is_named_with_the_cure(keys: Path, name: str) -> None:
    path = keys / name
    kept = path.read_bytes()
    path.unlink()
    try:
        with pytest.raises(KeysError, match=rf"{name}: no such file.*tritrack keys FOLDER"):
            refuse_missing(keys, "viewer1")
    finally:
        path.write_bytes(kept)
        path.chmod(0o600)


def test_a_plain_bus_is_as_before() -> None:
    place = BusSettings(free_endpoint())
    with open_hub(place, ROOM) as hub, open_client(place, ROOM, SOON_S, "viewer1") as client:
        heard, came, until_s = hub.subscribe(Body), None, time.monotonic() + SOON_S
        while came is None and time.monotonic() < until_s:
            client.publish(a_body(3, random_joints(1)[0]))
            came = heard.take(0.1)
    assert came is not None
    assert came.frame == 3


@pytest.mark.parametrize(("part", "side"), [("integrator", "listen"), ("viewer2", "connect")])
def test_each_side_shows_its_own_certificate_and_checks_the_others(
    tmp_path: Path, part: Part, side: str
) -> None:
    for name in ("ca.pem", f"{part}.pem", f"{part}.key"):
        (tmp_path / name).touch()
    assert tls_of(tmp_path, part) == {
        "root_ca_certificate": str(tmp_path / "ca.pem"),
        f"{side}_certificate": str(tmp_path / f"{part}.pem"),
        f"{side}_private_key": str(tmp_path / f"{part}.key"),
        "enable_mtls": True,
        "verify_name_on_connect": True,
    }
    (tmp_path / f"{part}.key").unlink()
    with pytest.raises(KeysError, match=rf"{part}\.key: no such file or directory; copy it from"):
        tls_of(tmp_path, part)
