"""A body for Foxglove: a stick figure in its 3-D panel, and numbers by name for its plots.

Source: Foxglove's message schemas (SceneUpdate, SceneEntity, LinePrimitive, SpherePrimitive). Its
axes are x forward, y left, z up: a run's z, x and y.
"""

from typing import Final

import msgspec

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES, LIMB_ENDS
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_LINES
from common.bus.messages import Body, Point
from common.npz_file import Facts

SCENE: Final = "foxglove.SceneUpdate"
NUMBERS: Final = "tritrack.BodyNumbers"
FRAME_ID: Final = "room"
RADIUS_M: Final = 0.05
LINE_LIST: Final = 2
_NUMBER: Final = {"type": "number"}
_ZERO: Final = {"sec": 0, "nsec": 0}
LIFETIME_S: Final = 0.5
"""How long the figure of one of several people stays without a newer one: who is gone has none."""
_STILL: Final = {
    "position": {"x": 0.0, "y": 0.0, "z": 0.0},
    "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
}
_GIRDLES: Final = [
    [JOINT_NAMES.index(f"{side}_{joint}") for side in "lr"] for joint in ("shoulder", "hip")
]
_LINES: Final = [*LIMB_ENDS.tolist(), *_GIRDLES]


def scene_of(body: Body) -> bytes:
    """A SceneUpdate as JSON: lines between a body's joints and to the ends of hands and feet, and
    balls at the 15 joints coloured by confidence.

    A body without a pose removes the figure. Each of several people has a figure of their own.
    """
    figure = f"body {body.person}" if body.person > 0 else "body"
    if not body.joints_m:
        gone = {"timestamp": time_of(body.captured_s), "type": 0, "id": figure}
        return msgspec.json.encode({"deletions": [gone], "entities": []})
    places_m = (*body.joints_m, *body.extremities_m)
    drawn = [*_LINES, *(EXTREMITY_LINES if body.extremities_m else [])]
    lines = {
        "type": LINE_LIST,
        "pose": _STILL,
        "thickness": RADIUS_M / 2,
        "scale_invariant": False,
        "points": [_place(places_m[end]) for ends in drawn for end in ends],
        "color": _colour(1.0),
        "colors": [],
        "indices": [],
    }
    entity = {
        "timestamp": time_of(body.captured_s),
        "frame_id": FRAME_ID,
        "id": figure,
        "lifetime": time_of(LIFETIME_S) if body.person > 0 else _ZERO,
        "frame_locked": False,
        "metadata": [],
        **{name: [] for name in ("arrows", "cubes", "cylinders", "triangles", "texts", "models")},
        "lines": [lines],
        "spheres": [
            {
                "pose": {**_STILL, "position": _place(place_m)},
                "size": dict.fromkeys("xyz", 2 * RADIUS_M),
                "color": _colour(sure),
            }
            for place_m, sure in zip(body.joints_m, body.confidence, strict=True)
        ],
    }
    return msgspec.json.encode({"deletions": [], "entities": [entity]})


def numbers_of(body: Body) -> bytes:
    """A body's numbers by name, as JSON: angles_deg.l_elbow_x, joints_m.l_wrist.y and so on."""
    places_m = (*(body.joints_m or ()), *body.extremities_m)
    joints = {name: _xyz(place) for name, place in zip(ALL_JOINT_NAMES, places_m, strict=False)}
    angles = {
        name: body.pose[i] for name, i in zip(ANGLE_NAMES, ANGLES_IN_POSE, strict=True) if body.pose
    }
    told = {"frame": body.frame, "person": body.person, "status": body.status, "views": body.views}
    sure = (*body.confidence, *body.extremities_confidence)
    confidence = dict(zip(ALL_JOINT_NAMES, sure, strict=False))
    return msgspec.json.encode(
        told | {"joints_m": joints, "angles_deg": angles, "confidence": confidence}
    )


def schemas() -> dict[str, bytes]:
    """JSON Schema of both, without references: not all readers resolve them."""
    xyz = _object(dict.fromkeys("xyz", _NUMBER))
    time = _object({"sec": {"type": "integer"}, "nsec": {"type": "integer"}})
    turn = _object(dict.fromkeys("xyzw", _NUMBER))
    pose = _object({"position": xyz, "orientation": turn})
    colour = _object(dict.fromkeys("rgba", _NUMBER))
    lines = _object(
        {
            "type": {"type": "integer"},
            "pose": pose,
            "thickness": _NUMBER,
            "scale_invariant": {"type": "boolean"},
            "points": _list(xyz),
            "color": colour,
            "colors": _list(colour),
            "indices": _list({"type": "integer"}),
        }
    )
    entity = _object(
        {
            "timestamp": time,
            "frame_id": {"type": "string"},
            "id": {"type": "string"},
            "lifetime": time,
            "frame_locked": {"type": "boolean"},
            "spheres": _list(_object({"pose": pose, "size": xyz, "color": colour})),
            "lines": _list(lines),
        }
    )
    gone = _object({"timestamp": time, "type": {"type": "integer"}, "id": {"type": "string"}})
    scene = _object({"deletions": _list(gone), "entities": _list(entity)})
    numbers = _object(
        {
            "frame": {"type": "integer"},
            "person": {"type": "integer"},
            "status": {"type": "string"},
            "views": {"type": "string"},
            "joints_m": _object(dict.fromkeys(ALL_JOINT_NAMES, xyz)),
            "angles_deg": _object(dict.fromkeys(ANGLE_NAMES, _NUMBER)),
            "confidence": _object(dict.fromkeys(ALL_JOINT_NAMES, _NUMBER)),
        }
    )
    return {SCENE: msgspec.json.encode(scene), NUMBERS: msgspec.json.encode(numbers)}


def time_of(seconds: float) -> dict[str, int]:
    """Seconds in Foxglove's form."""
    whole, nanoseconds = divmod(round(seconds * 1e9), 1_000_000_000)
    return {"sec": whole, "nsec": nanoseconds}


def _object(properties: Facts) -> Facts:
    return {"type": "object", "properties": properties}


def _list(of: Facts) -> Facts:
    return {"type": "array", "items": of}


def _xyz(place: Point) -> dict[str, float]:
    return dict(zip("xyz", place, strict=True))


def _place(place_m: Point) -> dict[str, float]:
    x, y, z = place_m
    return {"x": z, "y": x, "z": y}


def _colour(sure: float) -> dict[str, float]:
    return {"r": 1.0 - sure, "g": 0.3 + 0.5 * sure, "b": 0.3, "a": 1.0}
