"""A web page of somebody else, served at another port, and what it tries in a browser."""

import http.server
import threading
from collections.abc import Iterator
from contextlib import contextmanager

TRIES = """<!doctype html><title>nothing yet</title><script>
const told = {};
const tell = (what, how) => { told[what] = how; document.title = JSON.stringify(told); };
const image = new Image();
image.onload = () => tell("image", "seen");
image.onerror = () => tell("image", "refused");
image.src = "ADDRESS/STILL";
const socket = new WebSocket("ADDRESS/live".replace("http", "ws"));
socket.onmessage = () => tell("socket", "heard");
socket.onerror = () => tell("socket", "refused");
fetch("ADDRESS/", { credentials: "include" }).then(
  () => tell("page", "read"), () => tell("page", "refused"));
</script>"""
"""Shows in its title what came of it."""


@contextmanager
def foreign_page(host: str, address: str, still: str) -> Iterator[str]:
    """The address of a page that tries to see, hear and read what is at another's."""
    content = TRIES.replace("ADDRESS", address).replace("STILL", still).encode()

    class Answer(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: object) -> None:
            pass

    with http.server.ThreadingHTTPServer((host, 0), Answer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://{host}:{server.server_port}/"
        finally:
            server.shutdown()
