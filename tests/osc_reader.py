"""Open Sound Control, read by hand: addresses and values of a datagram (OSC 1.0)."""

import struct
from typing import Any


def read_osc(packet: bytes) -> list[tuple[str, list[Any]]]:
    """All messages of a packet, bundles opened."""
    if not packet.startswith(b"#bundle\0"):
        return [_message(packet)]
    found, at = [], 16
    while at < len(packet):
        (size,) = struct.unpack_from(">i", packet, at)
        found += read_osc(packet[at + 4 : at + 4 + size])
        at += 4 + size
    return found


def _message(packet: bytes) -> tuple[str, list[Any]]:
    address, at = _text(packet, 0)
    types, at = _text(packet, at)
    values: list[Any] = []
    for kind in types[1:]:
        if kind == "s":
            text, at = _text(packet, at)
            values.append(text)
        else:
            layout = {"i": ">i", "f": ">f", "d": ">d"}[kind]
            values.append(struct.unpack_from(layout, packet, at)[0])
            at += struct.calcsize(layout)
    assert at == len(packet)
    return address, values


def _text(packet: bytes, at: int) -> tuple[str, int]:
    end = packet.index(b"\0", at)
    return packet[at:end].decode(), at + (end - at) // 4 * 4 + 4
