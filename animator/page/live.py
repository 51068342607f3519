"""The live page: a viser server of this machine alone that shows the newest snapshot."""

import math
from typing import Final

import numpy as np

from animator.page import panel
from animator.page.door import HOST, close_server, open_server
from animator.page.inset import draw_contours, inset, limb_contours, limb_ends
from animator.page.shapes import add_shapes, place_shapes
from animator.scene import (
    BALLS,
    Snapshot,
    figure,
    frustum,
    limb_shapes,
    round_shapes,
    rows_of,
    viewpoint,
)
from animator.solids import unit_ball, unit_cylinder
from common.body.body import LIMBS
from common.body.kinematics import HEAD
from common.bus.messages import Body
from common.rig.camera import Rig

FLOOR_M: Final = 8.0
"""Side of the floor that is drawn round the middle of the room: a person's range and more."""
CELL_M: Final = 0.5
PLANE_SHARE: Final = 0.6
"""Where a camera's picture hangs on the way from the camera to the middle of the room."""
FOV_RAD: Final = math.radians(38.0)
"""The spectator's angle of view: narrow, so that upright bodies stay upright at the edges."""
PANEL_PX: Final = 360
SKY_LIGHT, SUN_LIGHT = 1.1, 1.3
"""Together they show a colour about as it was given; viser's own lights wash it out."""
SUN_AT: Final = (-1.5, 4.0, 2.5)

INK: Final = (150, 159, 170)
CYLINDERS: Final = [i for i in range(len(LIMBS)) if i != HEAD]
"""The limbs that are drawn as cylinders; the head is round."""


class LivePage:
    """What a browser on this machine sees at `address`, until `close`.

    Args:
        rig: The cameras of this run, one or two, in the order of the viewers.
        port: Of this machine, free.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """

    def __init__(self, rig: Rig, port: int) -> None:
        self._rig = rig
        self._server = open_server(port)
        self._build_room()
        self._build_body()
        self._build_cameras()
        self._build_panel()
        self.show(Snapshot())

    @property
    def address(self) -> str:
        """Where a browser finds the page."""
        return f"http://{HOST}:{self._server.get_port()}"

    def show(self, snapshot: Snapshot) -> None:
        """Bring the page up to date; every browser that is connected follows."""
        with self._server.atomic():
            self._show_body(snapshot.body)
            self._show_cameras(snapshot)
            self._show_panel(snapshot)

    def close(self) -> None:
        """Take the page down and free the port."""
        close_server(self._server)

    def _build_room(self) -> None:
        server, scene = self._server, self._server.scene
        server.gui.configure_theme(
            show_logo=False, show_share_button=False, brand_color=panel.ACCENT
        )
        server.gui.main_panel.dock_right()
        server.gui.main_panel.set_width(PANEL_PX)
        scene.set_up_direction("+y")
        scene.world_axes.visible = False
        spectator = viewpoint(self._rig)
        server.initial_camera.position = spectator.position
        server.initial_camera.look_at = spectator.look_at
        server.initial_camera.fov = FOV_RAD
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(None)
        scene.add_light_hemisphere("/sky", ground_color=(170, 178, 188), intensity=SKY_LIGHT)
        scene.add_light_directional(
            "/sun",
            intensity=SUN_LIGHT,
            cast_shadow=True,
            position=tuple(spectator.look_at + SUN_AT),
        )
        scene.add_grid(
            "/floor",
            FLOOR_M,
            FLOOR_M,
            position=tuple(np.rint(spectator.look_at) * (1.0, 0.0, 1.0)),
            plane="xz",
            cell_size=CELL_M,
            section_size=2 * CELL_M,
            cell_color=(226, 230, 234),
            section_color=(196, 203, 210),
            plane_color=(246, 247, 248),
            plane_opacity=1.0,
            shadow_opacity=0.25,
        )

    def _build_body(self) -> None:
        scene = self._server.scene
        self._cylinders = add_shapes(scene, "/body/cylinders", unit_cylinder(), len(CYLINDERS))
        self._balls = add_shapes(scene, "/body/balls", unit_ball(), BALLS)

    def _build_cameras(self) -> None:
        self._frustums = []
        middle = viewpoint(self._rig).look_at
        for n, camera in enumerate(self._rig.cameras, start=1):
            seen = frustum(camera, (self._rig.width, self._rig.height))
            handle = self._server.scene.add_camera_frustum(
                f"/camera {n}",
                seen.fov_rad,
                seen.aspect,
                thickness=0.008,
                color=INK,
                wxyz=seen.wxyz,
                position=seen.position,
                format="jpeg",
                cast_shadow=False,
            )
            plane_m = PLANE_SHARE * float(np.linalg.norm(seen.position - middle))
            handle.scale = plane_m / handle.compute_canonical_frustum_size()[2]
            above = (0.0, -1.03 * plane_m * math.tan(seen.fov_rad / 2), plane_m)
            self._server.scene.add_label(
                f"/camera {n}/name", f"camera {n}", position=above, anchor="bottom-center"
            )
            self._frustums.append(handle)

    def _build_panel(self) -> None:
        gui = self._server.gui
        self._headline = gui.add_html("")
        self._events = gui.add_html("")
        self._status = gui.add_html("")
        self._views = gui.add_html("")
        self._bars = gui.add_html("")
        gui.add_html(panel.legend())
        with gui.add_folder("Processes"):
            self._pulses = gui.add_html("")

    def _show_body(self, body: Body | None) -> None:
        standing = figure(body)
        self._cylinders.visible = self._balls.visible = standing is not None
        if standing is not None:
            limbs = limb_shapes(standing)
            place_shapes(self._cylinders, rows_of(limbs, CYLINDERS))
            place_shapes(self._balls, round_shapes(limbs))

    def _show_cameras(self, snapshot: Snapshot) -> None:
        standing = figure(snapshot.body)
        ends = None if standing is None else limb_ends(standing)
        for n, camera in enumerate(self._rig.cameras, start=1):
            report = snapshot.reports.get(n)
            image = None if report is None else inset(report, snapshot.pictures.get(n))
            if image is not None and ends is not None:
                draw_contours(image, limb_contours(camera, ends), self._rig.width)
            self._frustums[n - 1].image = image

    def _show_panel(self, snapshot: Snapshot) -> None:
        body, pulses = snapshot.body, snapshot.pulses.values()
        self._headline.content = panel.posture_headline(snapshot.posture)
        self._events.content = panel.events_list(snapshot.performances)
        self._status.content = panel.status_line(body, pulses)
        self._views.content = panel.views_table(body, snapshot.reports, len(self._rig.cameras))
        self._bars.content = panel.likelihood_bars(snapshot.posture)
        self._pulses.content = panel.pulse_table(pulses)
