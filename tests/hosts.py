"""Simulated hosts: each a network namespace of its own, with a cable to one switch between them.

The switch is a thread of ours that hands Ethernet frames from tap to tap, so that a cable may be
cut, slow or lossy also where the kernel has no `netem`. A host's monotonic clock may be ahead of
this machine's (a time namespace), as those of real hosts are.
"""

import fcntl
import heapq
import os
import random
import select
import shutil
import signal
import struct
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import IO, Final, NamedTuple

NETWORK: Final = "10.77.0"
TOOLS: Final = ("ip", "unshare")
TUNSETIFF: Final = 0x400454CA
TAP_WITHOUT_HEADER: Final = 0x0002 | 0x1000
MOST_BYTES: Final = 1 << 16
END_S: Final = 10.0


class Unsimulated(RuntimeError):
    """This machine cannot simulate hosts; the text says why."""


class Cable(NamedTuple):
    """What a cable does to packets, each way."""

    delay_s: float = 0.0
    loss: float = 0.0
    """Share that never comes."""
    cut: bool = False


class Switch:
    """Hands Ethernet frames on, by a thread of its own."""

    def __init__(self, taps: dict[str, int], seed: int = 15) -> None:
        """Of open taps, by the hosts' names; all cables are good."""
        self.cables = {name: Cable() for name in taps}
        self._taps, self._names = taps, {tap: name for name, tap in taps.items()}
        self._random = random.Random(seed)
        self._behind: dict[bytes, str] = {}
        self._waiting: list[tuple[float, int, str, bytes]] = []
        self._count = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._over.is_set():
            wait_s = self._waiting[0][0] - time.monotonic() if self._waiting else 0.05
            ready, _, _ = select.select([*self._names], [], [], min(0.05, max(0.0, wait_s)))
            for tap in ready:
                self._came(self._names[tap], os.read(tap, MOST_BYTES))
            while self._waiting and self._waiting[0][0] <= time.monotonic():
                _, _, name, frame = heapq.heappop(self._waiting)
                os.write(self._taps[name], frame)

    def _came(self, sender: str, frame: bytes) -> None:
        to, by = frame[:6], frame[6:12]
        self._behind[by] = sender
        known = self._behind.get(to)
        for name in [known] if known else [name for name in self._taps if name != sender]:
            ways = self.cables[sender], self.cables[name]
            if any(way.cut or self._random.random() < way.loss for way in ways):
                continue
            self._count += 1
            due_s = time.monotonic() + sum(way.delay_s for way in ways)
            heapq.heappush(self._waiting, (due_s, self._count, name, frame))


class Hosts:
    """Hosts on one switch."""

    def __init__(self, names: Sequence[str], doors: ExitStack) -> None:
        """Plug them in; the doors unplug them.

        Raises:
            Unsimulated: When that is not allowed here, or a tool is missing.
        """
        missing = [tool for tool in TOOLS if shutil.which(tool) is None]
        if missing:
            raise Unsimulated(f"no {', '.join(missing)}: apt-get install iproute2 util-linux")
        self._prefix = f"tt{os.getpid()}"
        self.address = {name: f"{NETWORK}.{n}" for n, name in enumerate(names, 1)}
        taps = {name: self._plugged(n, name, doors) for n, name in enumerate(names)}
        self.switch = Switch(taps)
        doors.callback(self.switch.close)
        _tool("unshare", "--time", "--fork", "--monotonic", "1", "true")

    def cable(self, name: str, cable: Cable = Cable()) -> None:
        """What a host's cable is from now on."""
        self.switch.cables[name] = cable

    @contextmanager
    def running(
        self, name: str, command: Sequence[object], log: IO[str], ahead_s: int = 0
    ) -> Iterator[subprocess.Popen[str]]:
        """A process on a host whose monotonic clock is ahead of ours; ended with its children."""
        clock = ("unshare", "--time", "--monotonic", ahead_s, "--boottime", ahead_s)
        host = ("ip", "netns", "exec", f"{self._prefix}{name}", *clock, "--fork")
        process = subprocess.Popen(
            [str(word) for word in (*host, "--kill-child=SIGTERM", *command)],
            stdout=log,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        try:
            yield process
        finally:
            _end(process)

    def _plugged(self, n: int, name: str, doors: ExitStack) -> int:
        space, device = f"{self._prefix}{name}", f"{self._prefix}t{n}"
        _tool("ip", "netns", "add", space)
        doors.callback(_tool, "ip", "netns", "del", space)
        try:
            tap = os.open("/dev/net/tun", os.O_RDWR)
            doors.callback(os.close, tap)
            fcntl.ioctl(tap, TUNSETIFF, struct.pack("16sH", device.encode(), TAP_WITHOUT_HEADER))
        except OSError as error:
            raise Unsimulated(f"no tap device: {error}") from error
        _tool("ip", "link", "set", device, "netns", space, "name", "eth0")
        _tool("ip", "-n", space, "address", "add", f"{self.address[name]}/24", "dev", "eth0")
        _tool("ip", "-n", space, "link", "set", "eth0", "up")
        _tool("ip", "-n", space, "link", "set", "lo", "up")
        return tap


def _end(process: subprocess.Popen[str]) -> None:
    for number in (signal.SIGTERM, signal.SIGKILL):
        if process.poll() is None:
            os.killpg(process.pid, number)
            try:
                process.wait(END_S)
            except subprocess.TimeoutExpired:
                continue


def _tool(*words: str) -> None:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise Unsimulated(f"{' '.join(words)}: {done.stderr.strip()}")


@contextmanager
def hosts_of(names: Sequence[str]) -> Iterator[Hosts]:
    """Hosts of these names, until the end of the `with`.

    Raises:
        Unsimulated: When this machine cannot simulate them.
    """
    with ExitStack() as doors:
        yield Hosts(names, doors)
