"""Who can reach an endpoint, by what may stand in a settings file."""

import socket

import pytest

from common.endpoint import is_exposed, is_loopback


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
