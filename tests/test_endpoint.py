"""Who can reach an endpoint, by what may stand in a settings file."""

import socket

import pytest

from common.endpoint import address_of, is_endpoint, is_exposed, is_host, is_loopback


@pytest.mark.parametrize(
    ("endpoint", "exposed"),
    [
        ("tcp/127.0.0.1:7447", False),
        ("tcp/127.8.9.1:7447", False),
        ("tls/localhost:7447", False),
        ("tcp/[::1]:7447", False),
        ("tcp/[::1]:7447#iface=lo", False),
        ("unixsock-stream//run/tritrack.sock", False),
        ("tcp/0.0.0.0:7447", True),
        ("tcp/[::]:7447", True),
        ("tcp/:::7447", True),
        ("tcp/:7447", True),
        ("tcp/192.168.1.5:7447", True),
        ("tcp/192.168.1.5:+7447", True),
        ("tcp/192.168.1.5:7447?prio=1", True),
        ("udp/rig.local:7447", True),
        ("tcp/localhost.evil.example:7447", True),
        ("tcp/127.0.0.1.evil.example:7447", True),
        ("tcp/127.0.0.1@evil.example:7447", True),
        ("tcp/2130706433:7447", True),
        ("tcp/[::ffff:192.168.1.5]:7447", True),
    ],
)
def test_only_this_machines_own_addresses_are_out_of_reach(endpoint: str, exposed: bool) -> None:
    assert is_exposed(endpoint) is exposed


def test_what_is_called_loopback_is_where_the_system_takes_it_to_be() -> None:
    for host in ("127.0.0.1", "localhost"):
        assert is_loopback(host)
        found = socket.getaddrinfo(host, 80, socket.AF_INET)
        assert all(str(each[4][0]).startswith("127.") for each in found)


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp/127.0.0.1:7447",
        "tcp/[::1]:7447#iface=lo",
        "tls/rig.local:7447",
        "udp/rig.local:+7447",
        "unixsock-stream//run/tritrack.sock",
    ],
)
def test_what_zenoh_takes_is_an_endpoint(endpoint: str) -> None:
    assert is_endpoint(endpoint)


@pytest.mark.parametrize(
    "text", ["", "7447", "127.0.0.1:7447", "tcp/127.0.0.1", "tcp/a:0", "tcp/a:65536", "tcp/a b:1"]
)
def test_what_names_no_way_or_no_port_is_none(text: str) -> None:
    assert not is_endpoint(text)


@pytest.mark.parametrize("host", ["a" * 64, "a..b", "a\0b", "a b", "a/b"])
def test_what_cannot_be_looked_up_is_no_host(host: str) -> None:
    assert not is_host(host)
    with pytest.raises((UnicodeError, ValueError, OSError)):
        socket.getaddrinfo(host, 80)


def test_an_address_is_a_host_and_a_port() -> None:
    assert address_of("127.0.0.1:9464") == ("127.0.0.1", 9464)
    assert address_of("[::1]:65535") == ("[::1]", 65535)
    assert address_of("rig.local:1") == ("rig.local", 1)


@pytest.mark.parametrize(
    "text", ["", "9464", ":9464", "a:", "a:0", "a:65536", "a:-1", "a b:1", "a:x"]
)
def test_what_is_no_address_is_refused_as_it_was_written(text: str) -> None:
    with pytest.raises(ValueError, match=f"^metrics must look like 127.0.0.1:9464, got {text!r}$"):
        address_of(text)


def test_a_port_may_be_the_last_and_a_part_of_a_name_63_letters() -> None:
    assert is_endpoint("tcp/a:65535")
    assert is_endpoint("tcp/a:1")
    assert is_host("a" * 63)
    assert not is_host("a\u200bb")
    assert not is_endpoint("tcp/a..b:7447")
