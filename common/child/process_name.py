"""The name that `top` and `ps` show of a process, where there is one to be set: on Linux."""

from contextlib import suppress
from pathlib import Path


def be_shown_as(name: str) -> None:
    """Give this process a name; of a longer one the first 15 letters."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name)
