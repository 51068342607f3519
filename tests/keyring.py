"""Keys for tests, and a bus that uses them on the loopback."""

import json
from pathlib import Path

import zenoh
from meeting import free_endpoint

from common.config.part_settings import BusSettings


def with_keys(folder: Path, endpoint: str = "") -> BusSettings:
    address = (endpoint or free_endpoint()).partition("/")[2]
    return BusSettings(endpoint=f"tls/{address}", keys=str(folder))


def foreign(mode: str, place: dict[str, str], tls: dict[str, object]) -> zenoh.Session:
    """A session of a program that is not ours; `place` says where it listens or connects to."""
    config = zenoh.Config()
    told: dict[str, object] = {"mode": mode, "scouting/multicast/enabled": False}
    told |= {f"{side}/endpoints": [endpoint] for side, endpoint in place.items()}
    for name, value in {**told, "transport/link/tls": tls}.items():
        config.insert_json5(name, json.dumps(value))
    return zenoh.open(config)


def tls_as(keys: Path, name: str, side: str = "connect") -> dict[str, object]:
    return {
        "root_ca_certificate": str(keys / "ca.pem"),
        f"{side}_certificate": str(keys / f"{name}.pem"),
        f"{side}_private_key": str(keys / f"{name}.key"),
        "enable_mtls": True,
    }
