"""Keys for tests, and a bus that uses them on the loopback."""

from pathlib import Path

from meeting import free_endpoint

from common.config import BusSettings


def with_keys(folder: Path, endpoint: str = "") -> BusSettings:
    address = (endpoint or free_endpoint()).partition("/")[2]
    return BusSettings(endpoint=f"tls/{address}", keys=str(folder))
