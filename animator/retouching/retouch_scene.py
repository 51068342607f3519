"""The scene of the retouching page: a picture with its stick body, and the body from the side."""

import math
from collections.abc import Callable
from typing import Any, Final

import numpy as np
import viser
from numpy.typing import NDArray

from animator.overlay import STROKES
from animator.retouching.shapes import add_shapes, place_shapes
from animator.scene import LEFT, RIGHT, TRUNK, UNSURE, Colour, Shapes
from animator.solids import unit_ball, unit_cylinder
from animator.turns import arc
from common.body.body import JOINT_NAMES, LIMBS, Vector

TALL_M: Final = 2.0
"""Height of the picture in the scene, metres: about that of the body beside it."""
GAP_M: Final = 0.9
"""Distance from the picture to the middle of the body."""
FOV_RAD: Final = math.radians(30.0)
ASPECT: Final = 1.25
"""Width over height of the window's part beside the panel."""
STANDS_BACK: Final = 0.25
"""In a portrait window, a phone's, the panel covers the lower half: the scene's middle is raised
by this share of the height."""
RESIZED: Final = 0.02
"""Change of a window's width over height that means it was turned."""
BALL_M: Final = 0.022
"""Radius of a joint, metres: large enough to grab."""
CHOSEN: Final = 1.7
"""Size of the chosen joint, over that of the others."""
FRONT_M: Final = 0.02
"""Distance of the stick body in front of the picture, so that nothing of it is hidden."""
SKY_LIGHT, SUN_LIGHT = 1.0, 0.9
"""Intensities of two lights that together show a body's colours about as they are, from the
front."""
UP: Final = np.array([0.0, 1.0, 0.0])
PLACED: Final[Colour] = (62, 142, 126)
"""Colour of a joint that the user placed."""

Picture = NDArray[np.uint8]
"""(H, W, 3), red, green, blue."""


class RetouchScene:
    """The objects in the page's scene.

    Args:
        server: The page's server.
        size: Width and height of the video.
        picture: The first picture.
        placed: Called with a dragged joint and its place, in the video's pixels.
        clicked: Called with the index in LIMBS of a clicked segment.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        size: tuple[int, int],
        picture: Picture,
        placed: Callable[[int, tuple[float, float]], None],
        clicked: Callable[[int], None],
    ) -> None:
        self._scene = server.scene
        self._placed, self._clicked = placed, clicked
        self._m_per_px = TALL_M / size[1]
        self._wide_m = size[0] * self._m_per_px
        self._build_light(server)
        self._image = self._scene.add_image(
            "/picture",
            picture,
            self._wide_m,
            TALL_M,
            format="jpeg",
            wxyz=(0.0, 1.0, 0.0, 0.0),
            position=(self._wide_m / 2, TALL_M / 2, 0.0),
            cast_shadow=False,
            receive_shadow=False,
        )
        self._lines = self._scene.add_line_segments(
            "/stick", np.zeros((len(STROKES), 2, 3)), _line_colours(), thickness=0.018
        )
        self._balls = add_shapes(self._scene, "/joints", unit_ball(), len(JOINT_NAMES))
        self._body = add_shapes(self._scene, "/body", unit_cylinder(), len(STROKES))
        self._balls.on_drag("left")(self._dragged)
        self._body.on_click(self._hit)
        self._scene.add_label(
            "/side", "from the side", position=(self._wide_m + GAP_M, TALL_M + 0.05, 0.0)
        )

    def show(self, picture: Picture, posed: bool) -> None:
        """Update the picture, and hide stick body and body where there is no pose."""
        self._image.image = picture
        for handle in (self._balls, self._lines, self._body):
            handle.visible = posed

    def show_stick(self, joints_px: Vector, placed: set[str], chosen: int) -> None:
        """The stick body over the picture, (15, 2) in the video's pixels; one joint is chosen."""
        x, y = self._m_per_px * joints_px.T
        places = np.stack([x, TALL_M - y, np.full(len(x), FRONT_M)], axis=1)
        self._lines.points = places[[[stroke.near, stroke.far] for stroke in STROKES]]
        self._balls.batched_positions = places
        radii_m = np.where(np.arange(len(x)) == chosen, CHOSEN, 1.0) * BALL_M
        self._balls.batched_scales = np.repeat(radii_m[:, None], 3, axis=1)
        self._balls.batched_colors = np.array(
            [PLACED if name in placed else _side_colour(name) for name in JOINT_NAMES], np.uint8
        )

    def show_body(self, joints_m: Vector, unsure: set[str]) -> None:
        """The body turned by a quarter, the camera at its left; doubtful segments are pale."""
        at = joints_m - joints_m[0] * (1.0, 0.0, 1.0)
        places = np.stack([self._wide_m + GAP_M - at[:, 2], at[:, 1], at[:, 0]], axis=1)
        ends = places[[[stroke.near, stroke.far] for stroke in STROKES]]
        along = ends[:, 1] - ends[:, 0]
        tall_m = max(0.5, float(np.ptp(at[:, 1])))
        radii = np.array([stroke.thick for stroke in STROKES]) * tall_m
        colours = _line_colours()[:, 0]
        colours[[LIMBS.index(limb) for limb in unsure]] = UNSURE
        scales = np.stack([radii, np.linalg.norm(along, axis=1), radii], axis=1)
        wxyzs = arc(UP, along).as_quat(scalar_first=True)
        place_shapes(self._body, Shapes(ends[:, 0], wxyzs, scales, colours))

    def _build_light(self, server: viser.ViserServer) -> None:
        scene = self._scene
        scene.set_up_direction("+y")
        scene.world_axes.visible = False
        for camera, value in self._camera(ASPECT, 0.0).items():
            setattr(server.initial_camera, camera, value)
        server.initial_camera.fov = FOV_RAD
        server.on_client_connect(self._stand_back)
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(None)
        scene.add_light_hemisphere("/sky", ground_color=(170, 178, 188), intensity=SKY_LIGHT)
        scene.add_light_directional("/sun", intensity=SUN_LIGHT, position=(1.0, 4.0, 5.0))

    def _camera(self, aspect: float, up: float) -> dict[str, Vector]:
        """A viewpoint that shows everything, with its middle raised by a share of the height."""
        across_m = self._wide_m + 2 * GAP_M
        tall_m = max(1.2 * TALL_M, 1.1 * across_m / aspect)
        middle = np.array([across_m / 2, TALL_M / 2 - up * tall_m, 0.0])
        away = np.array([0.0, 0.0, tall_m / (2 * math.tan(FOV_RAD / 2))])
        return {
            "position": middle + away,
            "look_at": middle,
        }  # moves keep the direction

    def _stand_back(self, client: viser.ClientHandle) -> None:
        """Show the whole scene in a phone's window too, above the panel; again when the phone is
        turned, and when a busy browser reports its window's size late."""
        stands = 1.0

        def look(_: object = None) -> None:
            nonlocal stands
            narrow = min(client.camera.aspect, 1.0)
            if abs(narrow - stands) > RESIZED:
                stands = narrow
                seen = (narrow, STANDS_BACK) if narrow < 1.0 else (ASPECT, 0.0)
                for camera, value in self._camera(*seen).items():
                    setattr(client.camera, camera, value)

        look()
        client.camera.on_update(look)

    def _hit(self, event: Any) -> None:
        if event.instance_index is not None and event.instance_index < len(LIMBS):
            self._clicked(event.instance_index)

    async def _dragged(self, event: Any) -> None:
        """Follow the pointer over the picture; the joint is placed where the button is released."""
        joint = event.instance_index
        met = _on_picture(np.array(event.client.camera.position), np.array(event.end_position))
        if joint is None or met is None:
            return
        if event.phase == "end":
            column, row = met[0] / self._m_per_px, (TALL_M - met[1]) / self._m_per_px
            self._placed(joint, (round(float(column), 1), round(float(row), 1)))
            return
        places = np.array(self._balls.batched_positions)
        places[joint, :2] = met[:2]
        self._balls.batched_positions = places


def _on_picture(eye: Vector, pointer: Vector) -> Vector | None:
    """Intersection of the pointer's ray with the stick body's plane, if any."""
    ray = pointer - eye
    if abs(ray[2]) < 1e-9:
        return None
    met: Vector = eye + ray * ((FRONT_M - eye[2]) / ray[2])
    return met


def _line_colours() -> NDArray[np.uint8]:
    """Colours of both ends of every line, (n, 2, 3)."""
    return np.array([[stroke.colour] * 2 for stroke in STROKES], np.uint8)


def _side_colour(name: str) -> Colour:
    return LEFT if name.startswith("l_") else RIGHT if name.startswith("r_") else TRUNK
