"""Write docs/messages.schema.json, the JSON Schema of every message on the bus, from the types.

Run from the checkout: .venv/bin/python benchmarks/message_schema.py
"""

import argparse
import json
from pathlib import Path
from typing import Any, Final

import msgspec

from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMBS, POSE_NAMES
from common.body.extremities import EXTREMITY_NAMES
from common.bus.message_codec import TOPICS
from common.bus.messages import PROTOCOL
from common.config.part_settings import BusSettings
from common.config.settings import Settings

FILE: Final = Path(__file__).parents[1] / "docs" / "messages.schema.json"


def schema() -> dict[str, Any]:
    """Keys and shapes of all topics, and the orders that arrays have."""
    kinds = [*TOPICS]
    shapes, parts = msgspec.json.schema_components(kinds, ref_template="#/$defs/{name}")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"tritrack-messages-{PROTOCOL}",
        "title": f"Messages of tritrack, protocol {PROTOCOL}",
        "description": (
            "MessagePack over Zenoh. Every message carries `protocol`; one of another number is "
            "refused. Bytes, base64 here, are MessagePack's bin. captured_s counts from the clip's "
            "begin, or is the room's clock for a camera; clock_s is the same moment by the room's "
            "clock, the monotonic clock of the integrator's host. Places are metres, +y up, +z to "
            "camera 1, +x left of who faces it; the first pixel's centre is (0.5, 0.5)."
        ),
        "endpoint": BusSettings().endpoint,
        "room": Settings().room,
        "orders": {
            "joints": JOINT_NAMES,
            "extremities": EXTREMITY_NAMES,
            "angles": ANGLE_NAMES,
            "pose": POSE_NAMES,
            "limbs": LIMBS,
        },
        "topics": {
            kind.__name__: {**topic._asdict(), "schema": shape}
            for (kind, topic), shape in zip(TOPICS.items(), shapes, strict=True)
        },
        "$defs": dict(sorted(parts.items())),
        "anyOf": list(shapes),
    }


def text() -> str:
    """As the file has it."""
    return json.dumps(schema(), indent=1) + "\n"


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__).parse_args()
    FILE.write_text(text())
