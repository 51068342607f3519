"""What Foxglove is sent of a body: lines between joints, balls at them, and numbers by name."""

import json
from typing import Any

import msgspec
import pytest

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES, LIMB_ENDS
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_LINES, EXTREMITY_NAMES
from common.bus.messages import Body
from runtime.store.foxglove_scene import NUMBERS, SCENE, numbers_of, scene_of, schemas

JOINTS_M = tuple((0.1 * n, 1.0 + n, -2.0 * n) for n in range(len(JOINT_NAMES)))
ENDS_M = tuple((5.0 + n, 0.0, 0.5) for n in range(len(EXTREMITY_NAMES)))


def body(**more: Any) -> Body:
    moment: dict[str, Any] = {"frame": 7, "captured_s": 2.25, "clock_s": 2.25}
    return Body(status="tracking", views="both", **moment, **more)


def somebody() -> Body:
    return body(
        joints_m=JOINTS_M,
        confidence=(*[0.5] * (len(JOINT_NAMES) - 1), 1.0),
        pose=tuple(float(n) for n in range(max(ANGLES_IN_POSE) + 1)),
        extremities_m=ENDS_M,
        extremities_confidence=(0.25,) * len(EXTREMITY_NAMES),
    )


def drawn(place_m: tuple[float, float, float]) -> dict[str, float]:
    """Foxglove's axes: x forward, y left, z up."""
    return {"x": place_m[2], "y": place_m[0], "z": place_m[1]}


def test_a_figure_has_a_line_for_each_limb_and_a_ball_for_each_joint() -> None:
    scene = json.loads(scene_of(somebody()))
    assert scene["deletions"] == []
    (entity,) = scene["entities"]
    assert (entity["timestamp"], entity["id"]) == ({"sec": 2, "nsec": 250_000_000}, "body")
    (lines,) = entity["lines"]
    assert lines["type"] == 2, "LINE_LIST: pairs of points"
    places = (*JOINTS_M, *ENDS_M)
    shoulders, hips = (
        [JOINT_NAMES.index(f"{side}_{joint}") for side in "lr"] for joint in ("shoulder", "hip")
    )
    ends = [*LIMB_ENDS.tolist(), shoulders, hips, *EXTREMITY_LINES]
    assert lines["points"] == [drawn(places[n]) for pair in ends for n in pair]
    assert [ball["pose"]["position"] for ball in entity["spheres"]] == [*map(drawn, JOINTS_M)]
    assert {tuple(ball["size"].values()) for ball in entity["spheres"]} == {(0.1, 0.1, 0.1)}
    assert lines["thickness"] == 0.025
    unsure, sure = (entity["spheres"][n]["color"] for n in (0, -1))
    assert sure == lines["color"] == {"r": 0.0, "g": 0.8, "b": 0.3, "a": 1.0}
    assert unsure == {"r": 0.5, "g": pytest.approx(0.55), "b": 0.3, "a": 1.0}


def test_each_of_several_people_is_a_figure_that_goes_when_they_are_gone() -> None:
    alone, second = somebody(), msgspec.structs.replace(somebody(), person=2)
    (entity,), (other,) = (json.loads(scene_of(one))["entities"] for one in (alone, second))
    assert (entity["id"], entity["lifetime"]) == ("body", {"sec": 0, "nsec": 0})
    assert (other["id"], other["lifetime"]) == ("body 2", {"sec": 0, "nsec": 500_000_000})
    lost = json.loads(scene_of(body(person=2)))
    assert [gone["id"] for gone in lost["deletions"]] == ["body 2"]
    assert json.loads(numbers_of(second))["person"] == 2


def test_who_has_no_hands_and_feet_is_drawn_without_and_nobody_is_taken_away() -> None:
    alone = body(joints_m=JOINTS_M, confidence=(0.5,) * len(JOINT_NAMES))
    (entity,) = json.loads(scene_of(alone))["entities"]
    assert len(entity["lines"][0]["points"]) == 2 * (len(LIMB_ENDS) + 2)
    gone = json.loads(scene_of(body()))
    assert gone["entities"] == []
    assert gone["deletions"] == [
        {"timestamp": {"sec": 2, "nsec": 250_000_000}, "type": 0, "id": "body"}
    ]


def test_every_number_is_found_by_its_name() -> None:
    told = json.loads(numbers_of(somebody()))
    assert (told["frame"], told["status"], told["views"]) == (7, "tracking", "both")
    assert tuple(told["joints_m"]) == ALL_JOINT_NAMES == tuple(told["confidence"])
    wrist = JOINT_NAMES.index("l_wrist")
    assert tuple(told["joints_m"]["l_wrist"].values()) == JOINTS_M[wrist]
    assert told["confidence"]["l_wrist"] == 0.5
    assert told["confidence"][ALL_JOINT_NAMES[-1]] == 0.25
    assert list(told["angles_deg"].values()) == [float(n) for n in ANGLES_IN_POSE]
    assert tuple(told["angles_deg"]) == ANGLE_NAMES
    nobody = json.loads(numbers_of(body()))
    assert nobody["joints_m"] == nobody["angles_deg"] == nobody["confidence"] == {}


def test_the_schemas_describe_all_that_is_sent() -> None:
    """By a validator that is not ours; a key that is not described would not be shown."""
    validate = pytest.importorskip("jsonschema", reason="pip install 'tritrack[dev]'").validate
    told = {name: json.loads(text) for name, text in schemas().items()}
    assert told.keys() == {SCENE, NUMBERS}
    for sent, name in ((scene_of, SCENE), (numbers_of, NUMBERS)):
        for one in (somebody(), body()):
            content = json.loads(sent(one))
            validate(content, told[name])
            assert content.keys() <= told[name]["properties"].keys()
    entity = told[SCENE]["properties"]["entities"]["items"]["properties"]
    line = entity["lines"]["items"]["properties"]
    assert {"timestamp", "frame_id", "id", "spheres", "lines"} <= entity.keys()
    assert {"type", "pose", "thickness", "points", "color", "indices"} <= line.keys()
    assert line["points"]["items"]["properties"].keys() == {"x", "y", "z"}
    assert line["color"]["properties"].keys() == {"r", "g", "b", "a"}
    assert line["pose"]["properties"]["orientation"]["properties"].keys() == {"x", "y", "z", "w"}


def test_a_schema_names_every_field_that_a_message_has() -> None:
    """Of each object of a message: its keys are the schema's, but for the lists that stay empty."""
    empty = {"metadata", "arrows", "cubes", "cylinders", "triangles", "texts", "models"}
    kinds = {int: "integer", float: "number", str: "string", bool: "boolean"}

    def hold(value: Any, schema: Any) -> None:
        if isinstance(value, dict):
            assert schema["type"] == "object"
            assert value.keys() - empty == schema["properties"].keys()
            for name in schema["properties"]:
                hold(value[name], schema["properties"][name])
        elif isinstance(value, list):
            assert schema["type"] == "array"
            for one in value:
                hold(one, schema["items"])
        else:
            assert schema == {"type": kinds[type(value)]}

    told = {name: json.loads(schema) for name, schema in schemas().items()}
    assert [*told] == [SCENE, NUMBERS]
    hold(json.loads(scene_of(somebody())), told[SCENE])
    hold(json.loads(scene_of(body())), told[SCENE])
    hold(json.loads(numbers_of(somebody())), told[NUMBERS])
