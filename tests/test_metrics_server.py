"""Figures and health by HTTP: asked as Prometheus and load balancers ask."""

import socket
import urllib.error
import urllib.request

import pytest

pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")

from metrics_reader import read
from prometheus_client.core import GaugeMetricFamily

from runtime.live.free_ports import free_port
from runtime.outside.metrics_server import served


def free_address() -> str:
    return f"127.0.0.1:{free_port()}"


def asked(address: str, path: str) -> tuple[int, str]:
    try:
        with urllib.request.urlopen(f"http://{address}{path}", timeout=10) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def test_metrics_and_health_are_answered_and_nothing_else() -> None:
    said = [True, ["hall: well"]]
    address = free_address()
    gauge = GaugeMetricFamily("tritrack_up", "There.", value=1)
    with served(address, lambda: [gauge], lambda: (bool(said[0]), said[1])):  # type: ignore[arg-type,return-value]
        assert asked(address, "/healthz") == (200, "hall: well\n")
        said[:] = [False, ["viewer 1: it is gone", "viewer 2: it is gone"]]
        assert asked(address, "/healthz") == (503, "viewer 1: it is gone\nviewer 2: it is gone\n")
        code, text = asked(address, "/metrics")
        assert (code, read(text).value("tritrack_up")) == (200, 1.0)
        assert asked(address, "/etc/passwd")[0] == 404
    with socket.socket() as door:
        host, port = address.split(":")
        assert door.connect_ex((host, int(port))) != 0, "it is closed"


@pytest.mark.slow
def test_who_connects_and_says_nothing_keeps_nobody_waiting() -> None:
    address = free_address()
    host, port = address.split(":")
    with served(address, list, lambda: (True, ["well"])):
        silent = [socket.create_connection((host, int(port))) for _ in range(20)]
        assert asked(address, "/healthz")[0] == 200
        for one in silent:
            one.close()
