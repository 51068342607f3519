"""Ports of a run: what is held is named before anything starts."""

import secrets
import socket
import sys
from pathlib import Path

import msgspec
import pytest

from animator.page.door import PageError
from common.bus.bus_keys import PARTS, KeysError
from common.config.part_settings import BusSettings, CameraSettings, PageSettings
from common.config.settings import Settings
from runtime.live import free_ports
from runtime.live.free_ports import (
    PORTS,
    PortHeld,
    free_port,
    free_settings,
    own_session,
    ports,
    refuse_held_ports,
    with_free_endpoint,
)


def test_what_is_held_is_named_with_the_cure() -> None:
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        door.listen()
        port = door.getsockname()[1]
        held = Settings(bus=BusSettings(f"tcp/127.0.0.1:{port}"), page=PageSettings(port=0))
        with pytest.raises(PortHeld, match=f"tcp/127.0.0.1:{port}: address already in use; .*end"):
            refuse_held_ports(held)
        free = free_settings(Settings())
        page = Settings(bus=free.bus, page=PageSettings(port=port))
        with pytest.raises(PageError, match=rf"port {port}: .*set page\.port to another one$"):
            refuse_held_ports(page)
        pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")
        metrics = Settings(bus=free.bus, page=held.page, metrics=f"127.0.0.1:{port}")
        with pytest.raises(PortHeld, match=f"metrics on 127.0.0.1:{port}: address already in use"):
            refuse_held_ports(metrics)


def test_what_is_free_or_no_tcp_is_left_alone() -> None:
    refuse_held_ports(free_settings(Settings()))
    refuse_held_ports(Settings(bus=BusSettings("udp/127.0.0.1:7"), page=PageSettings(port=0)))


def test_each_run_has_a_word_of_its_own_unless_it_was_given_one() -> None:
    one, other = own_session(Settings()), own_session(Settings())
    assert one.bus.session != other.bus.session
    assert own_session(one) == one
    assert Settings().bus.session == ""


def test_an_endpoint_that_is_left_open_is_a_free_port_and_others_stay() -> None:
    open_ended = Settings(bus=BusSettings(endpoint="auto", session="mine"))
    one, other = with_free_endpoint(open_ended), with_free_endpoint(open_ended)
    assert one.bus.endpoint.startswith("tcp/127.0.0.1:")
    assert one.bus.endpoint != other.bus.endpoint
    assert one.bus.session == "mine"
    assert with_free_endpoint(one) == one


def test_the_ports_of_a_run_are_those_that_it_does_not_choose() -> None:
    assert ports(Settings()) == [7447, 8080]
    chosen = Settings(bus=BusSettings(endpoint="auto"), page=PageSettings(port=0))
    assert ports(chosen) == []
    assert ports(msgspec.structs.replace(chosen, metrics="127.0.0.1:9464")) == [9464]


def test_keys_that_are_not_there_are_named_before_anything_starts(tmp_path: Path) -> None:
    bus = BusSettings(endpoint="tls/127.0.0.1:7447", keys=str(tmp_path))
    with pytest.raises(KeysError, match=r"ca\.pem: no such file"):
        refuse_held_ports(free_settings(Settings(bus=bus, page=PageSettings(port=0))))


def test_every_part_of_a_live_run_needs_its_keys_and_who_listens_alone_does_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[str, str]] = []
    monkeypatch.setattr(
        free_ports, "refuse_missing", lambda folder, part: asked.append((str(folder), part))
    )
    bus = BusSettings(endpoint="tls/127.0.0.1:7447", keys="own")
    cameras = {name: CameraSettings(device=n) for n, name in enumerate(("cam1", "door", "cam7"))}
    refuse_held_ports(free_settings(Settings(bus=bus, page=PageSettings(port=0), cameras=cameras)))
    assert {folder for folder, _ in asked} == {"own"}
    viewers = {"viewer1", "viewer2", "viewer7"}
    assert sorted(part for _, part in asked) == sorted(
        part for part in PARTS if part in viewers or not part.startswith(("viewer", "client"))
    )


def test_free_settings_keep_all_but_the_ports_and_are_of_tls_where_there_are_keys() -> None:
    bus = BusSettings(endpoint="tls/127.0.0.1:7", keys="own", session="mine")
    given = Settings(bus=bus, page=PageSettings(port=5, wait=False), every=3)
    found = free_settings(given)
    assert found.bus.endpoint.startswith("tls/127.0.0.1:")
    assert (found.bus.session, found.bus.keys, found.every) == ("mine", "own", 3)
    assert found.page.port > 1024
    without = free_settings(msgspec.structs.replace(given, page=PageSettings(port=0)))
    assert without.page == PageSettings(port=0)
    auto = msgspec.structs.replace(given, bus=msgspec.structs.replace(bus, endpoint="auto"))
    assert with_free_endpoint(auto).bus.endpoint.startswith("tls/127.0.0.1:")


def test_what_a_port_needs_that_is_not_installed_is_named_with_its_cure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    free_ports.refuse_held_metrics("")
    with pytest.raises(
        PortHeld, match=r"need prometheus_client: pip install 'tritrack\[metrics\]'"
    ):
        free_ports.refuse_held_metrics("127.0.0.1:9")
    monkeypatch.setitem(sys.modules, "websockets", None)
    free_ports.refuse_held_page(Settings(page=PageSettings(port=0)))
    with pytest.raises(PortHeld, match=r"the page needs websockets: pip install 'tritrack\[page\]"):
        free_ports.refuse_held_page(Settings())


def test_a_free_port_is_none_that_an_outgoing_connection_takes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Linux: ip_local_port_range; RFC 6335, 6: the dynamic ports begin at 49152."""
    system = Path("/proc/sys/net/ipv4/ip_local_port_range")
    first = int(system.read_text().split()[0]) if system.is_file() else 49_152
    found = {free_port() for _ in range(20)}
    assert len(found) > 1
    assert all(1024 <= port < first for port in found)
    with socket.socket() as door:
        door.bind(("127.0.0.1", PORTS.start))
        drawn = iter((0, 1))
        monkeypatch.setattr(secrets, "randbelow", lambda _: next(drawn))
        assert free_port() == PORTS.start + 1
        monkeypatch.setattr(secrets, "randbelow", lambda _: 0)
        with pytest.raises(PortHeld, match="no free port among 100 from 20000 to 32767: end"):
            free_port()


def test_bus_and_page_get_two_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    found = iter((20_001, 20_001, 20_002))
    monkeypatch.setattr(free_ports, "free_port", lambda: next(found))
    free = free_settings(Settings())
    assert (free.bus.endpoint, free.page.port) == ("tcp/127.0.0.1:20001", 20_002)
