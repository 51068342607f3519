"""The easel's room, in the hands of a server that only keeps what it is given."""

import asyncio
import math
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest

pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")

from animator.overlay import STROKES
from animator.retouching import retouch_scene as easels
from animator.retouching.retouch_scene import (
    ASPECT,
    BALL_M,
    CHOSEN,
    FOV_RAD,
    FRONT_M,
    GAP_M,
    PLACED,
    STANDS_BACK,
    TALL_M,
    RetouchScene,
)
from animator.scene import LEFT, RIGHT, TRUNK, UNSURE
from common.body.body import JOINT_NAMES, LIMBS

SIZE = (320, 160)
PICTURE = np.zeros((160, 320, 3), np.uint8)
M_PER_PX = TALL_M / 160


class Room:
    """An easel, what it was made of, and what it told."""

    def __init__(self) -> None:
        self.server, self.told = MagicMock(), list[tuple[Any, ...]]()
        self.easel = RetouchScene(
            self.server,
            SIZE,
            PICTURE,
            lambda joint, place: self.told.append((joint, place)),
            lambda limb: self.told.append((limb,)),
        )

    def stands(self, aspect: float) -> Any:
        """A browser with such a window."""
        client = SimpleNamespace(camera=MagicMock(aspect=aspect, position=None))
        self.easel._stand_back(client)
        return client.camera


@pytest.fixture
def room() -> Room:
    return Room()


def test_the_picture_stands_upright_on_the_floor_beside_the_body(room: Room) -> None:
    given = room.server.scene.add_image.call_args
    assert given.args[2:4] == (320 * M_PER_PX, TALL_M)
    assert given.kwargs["position"] == (160 * M_PER_PX, TALL_M / 2, 0.0)
    label = room.server.scene.add_label.call_args
    assert label.kwargs["position"][0] == pytest.approx(320 * M_PER_PX + GAP_M)
    assert label.kwargs["position"][1] > TALL_M


def test_the_stick_lies_over_the_picture_in_the_colours_of_its_sides(room: Room) -> None:
    """Row 0 is at the top, and the joint that keys move is larger."""
    joints_px = np.stack([10.0 * np.arange(15), 160.0 - 5.0 * np.arange(15)], axis=1)
    room.easel.show_stick(joints_px, {"l_wrist"}, chosen=3)
    places = room.easel._balls.batched_positions
    assert places[:, 0] == pytest.approx(10.0 * M_PER_PX * np.arange(15))
    assert places[:, 1] == pytest.approx(5.0 * M_PER_PX * np.arange(15))
    assert (places[:, 2] == FRONT_M).all()
    radii = room.easel._balls.batched_scales
    assert radii[3] == pytest.approx([CHOSEN * BALL_M] * 3)
    assert np.delete(radii, 3, axis=0) == pytest.approx(np.full((14, 3), BALL_M))
    sides = {"l": LEFT, "r": RIGHT}
    for name, colour in zip(JOINT_NAMES, room.easel._balls.batched_colors, strict=True):
        side = sides.get(name[0], TRUNK) if name[1] == "_" else TRUNK
        assert tuple(colour) == (PLACED if name == "l_wrist" else side), name
    for stroke, (near, far) in zip(STROKES, room.easel._lines.points, strict=True):
        assert near == pytest.approx(places[stroke.near])
        assert far == pytest.approx(places[stroke.far])


def test_the_body_stands_beside_it_turned_by_a_quarter(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is to the camera is to the left; a segment is as long and as thick as it is."""
    kept: list[Any] = []
    monkeypatch.setattr(easels, "place_shapes", lambda _, shapes: kept.append(shapes))
    joints_m = np.random.default_rng(1).uniform(0.0, 1.5, (15, 3))
    room.easel.show_body(joints_m, {"l_upper_arm"})
    (shapes,) = kept
    tall_m = float(np.ptp(joints_m[:, 1]))
    middle_m = 320 * M_PER_PX + GAP_M
    for stroke, place, scale in zip(STROKES, shapes.positions, shapes.scales, strict=True):
        near, far = joints_m[stroke.near], joints_m[stroke.far]
        away = near - joints_m[0] * [1.0, 0.0, 1.0]
        assert place == pytest.approx([middle_m - away[2], away[1], away[0]])
        assert scale[1] == pytest.approx(np.linalg.norm(far - near))
        assert scale[[0, 2]] == pytest.approx([stroke.thick * tall_m] * 2)
    for i, limb in enumerate(LIMBS):
        pale = tuple(shapes.colours[i]) == tuple(UNSURE)
        assert pale == (limb == "l_upper_arm")


@pytest.mark.parametrize("posed", [True, False])
def test_stick_and_body_are_there_where_there_is_a_pose(room: Room, posed: bool) -> None:
    room.easel.show(PICTURE + 1, posed)
    assert (room.easel._image.image == 1).all()
    assert room.easel._balls.visible == room.easel._body.visible == posed


@pytest.mark.parametrize("aspect", [2.0, 0.5])
def test_all_of_it_is_seen_in_a_window_of_any_shape(room: Room, aspect: float) -> None:
    """A window that is broad is as it was at first; a phone's shows it over the panel."""
    camera = room.stands(aspect)
    across_m = 320 * M_PER_PX + 2 * GAP_M
    if aspect > 1.0:
        assert camera.position is None
        return
    away_m = float(np.linalg.norm(camera.position - camera.look_at))
    seen_tall_m = 2 * away_m * math.tan(FOV_RAD / 2)
    assert seen_tall_m * aspect == pytest.approx(1.1 * across_m)
    assert camera.look_at[0] == pytest.approx(across_m / 2)
    assert camera.look_at[1] == pytest.approx(TALL_M / 2 - STANDS_BACK * seen_tall_m)
    (again,) = camera.on_update.call_args.args
    camera.aspect, camera.position = 0.51, None
    again()
    assert camera.position is None, "as it was but for a hundredth"
    camera.aspect = 1.5
    again()
    seen_tall_m = 2 * float(np.linalg.norm(camera.position - camera.look_at))
    seen_tall_m *= math.tan(FOV_RAD / 2)
    assert seen_tall_m == pytest.approx(max(1.2 * TALL_M, 1.1 * across_m / ASPECT))
    assert camera.look_at[1] == pytest.approx(TALL_M / 2)


def dragged(room: Room, phase: str, joint: int | None, pointer: tuple[float, float, float]) -> None:
    """By a spectator 5 m before the picture's corner."""
    client = SimpleNamespace(camera=SimpleNamespace(position=(0.0, 0.0, 5.0)))
    event = SimpleNamespace(instance_index=joint, client=client, end_position=pointer, phase=phase)
    asyncio.run(room.easel._dragged(event))


def test_a_joint_follows_the_pointer_and_is_placed_where_it_is_let_go(room: Room) -> None:
    """The ray goes on from the pointer to the plane of the stick."""
    half_way = (0.5, 0.25, (5.0 + FRONT_M) / 2)
    room.easel._balls.batched_positions = np.zeros((15, 3))
    dragged(room, "update", 4, half_way)
    assert room.easel._balls.batched_positions[4] == pytest.approx([1.0, 0.5, 0.0])
    assert not np.delete(room.easel._balls.batched_positions, 4, axis=0).any()
    assert room.told == []
    dragged(room, "end", 4, half_way)
    assert room.told == [(4, (round(1.0 / M_PER_PX, 1), round((TALL_M - 0.5) / M_PER_PX, 1)))]
    dragged(room, "end", None, half_way)
    dragged(room, "end", 4, (1.0, 1.0, 5.0))
    assert len(room.told) == 1, "no joint, or along the picture"


def test_a_click_tells_the_segment_that_was_hit(room: Room) -> None:
    """The lines across shoulders and hips are none of LIMBS."""
    for index in (None, len(LIMBS), len(LIMBS) - 1, 0):
        room.easel._hit(SimpleNamespace(instance_index=index))
    assert room.told == [(len(LIMBS) - 1,), (0,)]


def test_the_room_is_lit_from_the_front_and_its_camera_looks_at_the_middle_of_all(
    room: Room,
) -> None:
    scene, camera = room.server.scene, room.server.initial_camera
    assert scene.set_up_direction.call_args.args == ("+y",)
    assert scene.world_axes.visible is False
    assert camera.fov == FOV_RAD
    across_m = 4.0 + 2 * GAP_M
    assert camera.look_at == pytest.approx([across_m / 2, 1.0, 0.0])
    tall_m = max(1.2 * TALL_M, 1.1 * across_m / ASPECT)
    assert camera.position == pytest.approx([across_m / 2, 1.0, tall_m / 2 / math.tan(FOV_RAD / 2)])
    assert scene.configure_default_lights.call_args.kwargs == {"enabled": False}
    assert scene.configure_environment_map.call_args.args == (None,)
    sky, sun = scene.add_light_hemisphere.call_args, scene.add_light_directional.call_args
    assert sky.kwargs == {"ground_color": (170, 178, 188), "intensity": 1.0}
    assert sun.kwargs == {"intensity": 0.9, "position": (1.0, 4.0, 5.0)}
    assert room.server.on_client_connect.call_args.args == (room.easel._stand_back,)
