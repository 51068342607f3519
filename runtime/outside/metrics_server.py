"""Metrics and health over HTTP, for Prometheus and for service monitors."""

import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from socketserver import ThreadingMixIn
from typing import Any, Final
from wsgiref.simple_server import WSGIRequestHandler, WSGIServer, make_server

from prometheus_client import CollectorRegistry, make_wsgi_app
from prometheus_client.core import Metric
from prometheus_client.registry import Collector

from common.endpoint import address_of
from common.npz_file import Facts

SLOW_S: Final = 5.0
"""Seconds after which an incomplete request is dropped."""
TEXT: Final = ("Content-Type", "text/plain; charset=utf-8")

Health = Callable[[], tuple[bool, Sequence[str]]]
"""Whether all is well, and lines about the state."""


@contextmanager
def served(address: str, metrics: Callable[[], Iterable[Metric]], health: Health) -> Iterator[None]:
    """Answer `/metrics` and `/healthz` meanwhile, in a separate thread.

    Args:
        address: `HOST:PORT` to listen on.
        metrics: Gives all metrics; called once per scrape.
        health: Gives the answer of `/healthz`: 200 where all is well, else 503.
    """
    registry = CollectorRegistry()
    registry.register(_Figures(metrics))
    to_metrics = make_wsgi_app(registry)

    def answer(request: Facts, start: Callable[..., Any]) -> Iterable[bytes]:
        if request["PATH_INFO"] == "/metrics":
            return to_metrics(request, start)
        if request["PATH_INFO"] != "/healthz":
            start("404 Not Found", [TEXT])
            return [b"there are /metrics and /healthz\n"]
        well, lines = health()
        start("200 OK" if well else "503 Service Unavailable", [TEXT])
        return ["".join(f"{line}\n" for line in lines).encode()]

    host, port = address_of(address)
    with make_server(host, port, answer, _Server, _Silent) as server:
        thread = threading.Thread(target=server.serve_forever, name="metrics", daemon=True)
        thread.start()
        try:
            yield
        finally:
            server.shutdown()
            thread.join()


class _Figures(Collector):
    """The library's interface for metrics."""

    def __init__(self, metrics: Callable[[], Iterable[Metric]]) -> None:
        self._metrics = metrics

    def collect(self) -> Iterable[Metric]:
        """Called once per scrape."""
        return self._metrics()


class _Server(ThreadingMixIn, WSGIServer):
    daemon_threads = True


class _Silent(WSGIRequestHandler):
    timeout = SLOW_S

    def log_message(self, format: str, *_: Any) -> None:
        """Requests are not logged."""
