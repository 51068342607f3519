"""A person in the paper's rig, seen by two viewers whose silhouettes are exact."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pytest
from posing import posed

from common.body.body import Bdp, Vector
from common.body.observation import Box, Observation, Search
from common.body.proportions import body_vector, thesis_bdp
from common.bus.instant import Instant
from common.bus.messages import Body, Guide, View, ViewerNumber
from common.config.settings import Settings
from common.method import METHODS, Method
from common.raster.kernel import draw_body, view_of
from common.raster.silhouette_report import box_of, pack, with_person
from common.raster.similarity import Mask
from common.rig.camera import Rig, paper_rig
from common.video.pictures import Image
from integrator import merge, merge_state
from integrator.merge_state import Start
from viewer import track
from viewer.captured_frame import CapturedFrame
from viewer.silhouette.silhouette import Seen

WIDTH, HEIGHT = 160, 120
RIG = paper_rig((WIDTH, HEIGHT), (200.0, 200.0), (4.0, 4.0))
PERSON = thesis_bdp(1.75)
NAVEL_M = PERSON.r_upper_leg.height + PERSON.r_lower_leg.height
PERIOD_S = 1 / 15
PAPER = Settings(mode="paper")
"""For drawn cylinders: the body that the paper fits, and one that no network was trained on."""
NOBODY = np.zeros((HEIGHT, WIDTH), np.bool_)


def standing(place_m: tuple[float, float] = (0.0, 0.0), **angles_deg: float) -> Vector:
    """The person on the floor at (X, Z); `down_m` lowers the navel."""
    down_m = angles_deg.pop("down_m", 0.0)
    pose = posed(**angles_deg)
    pose[:3] = place_m[0], NAVEL_M - down_m, place_m[1]
    return pose


def opening(place_m: tuple[float, float] = (0.0, 0.0)) -> Vector:
    return standing(place_m, r_shoulder_z=95.0, l_shoulder_z=265.0)


def squatting(hip_deg: float, **angles_deg: float) -> Vector:
    hip = np.radians(hip_deg)
    down_m = NAVEL_M * (1 - float(np.cos(hip)))
    legs = {f"{side}_hip_x": hip_deg for side in "rl"}
    legs |= {f"{side}_knee_x": -2 * hip_deg for side in "rl"}
    return standing((0.0, 0.0), down_m=down_m, **legs, **angles_deg)


def silhouettes(pose: Vector, body: Bdp = PERSON, rig: Rig = RIG) -> tuple[Mask, Mask]:
    """What both cameras see of a pose, in true perspective."""
    first, second = (
        draw_body(body_vector(body), pose, view_of(camera), (rig.width, rig.height))
        for camera in rig.cameras
    )
    return first, second


def exact(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let viewers take the picture for the silhouette; one that stands still is no fault, and it
    has no colours."""

    def step(state: None, picture: Image, _near: object) -> tuple[None, Seen]:
        mask, box = picture.view(np.bool_), box_of(picture)
        if box is None:
            return state, Seen(mask=mask, box=None, area_px=0, blobs=0, cut=False)
        cut = box.left == 0 or box.top == 0 or box.right == WIDTH - 1 or box.bottom == HEIGHT - 1
        return state, Seen(mask, box, int(mask.sum()), 1, cut)

    monkeypatch.setattr("viewer.camera_fault.init", lambda _: None)
    monkeypatch.setattr("viewer.camera_fault.step", lambda state, *_: (state, ""))
    monkeypatch.setattr("viewer.track._watched", lambda *_: None)
    monkeypatch.setattr("viewer.people.observed_people.clothes_colours", lambda *_: ())
    monkeypatch.setattr("viewer.silhouette.silhouette.init", lambda *_: None)
    monkeypatch.setattr("viewer.silhouette.silhouette.step", step)
    monkeypatch.setattr("viewer.silhouette.silhouette.without_things", lambda state, *_: state)


class Told(NamedTuple):
    """What came of one instant."""

    reports: tuple[View | None, View | None]
    body: Body
    guide: Guide


class Stage:
    """Two viewers and an integrator, stepped in lock-step."""

    def __init__(
        self,
        rig: Rig | None = RIG,
        settings: Settings = Settings(),
        views: Sequence[ViewerNumber] = (1, 2),
        method: Method | None = None,
    ) -> None:
        cameras = (None, None) if rig is None else rig.cameras
        settings = msgspec.structs.replace(settings, landmarks="none")  # outlines have no picture
        method, alone = method or METHODS[settings.mode], len(views) == 1
        self.viewers = {
            n: track.init(track.Setup(n, cameras[n - 1], settings, method, alone), None)  # type: ignore[arg-type]
            for n in views
        }
        self.state = merge_state.init(rig, PERIOD_S, settings, method, Start(alone))
        self.guide: Guide | None = None
        self.at = 0

    def see(self, masks: tuple[Mask | None, Mask | None]) -> Told:
        """One instant; None where a viewer says nothing."""
        reports: list[View | None] = [None, None]
        for n, viewer in self.viewers.items():
            mask = masks[n - 1]
            if mask is None:
                continue
            moment = self.at * PERIOD_S
            frame = CapturedFrame(self.at, moment, moment, mask.view(np.uint8))
            self.viewers[n], reports[n - 1] = track.step(viewer, frame, self.guide)
        self.state, body, self.guide = merge.step(self.state, Instant((reports[0], reports[1])))
        self.at += 1
        return Told((reports[0], reports[1]), body, self.guide)

    def show(self, poses: Iterable[Vector], body: Bdp = PERSON) -> list[Told]:
        return [self.see(silhouettes(pose, body)) for pose in poses]


def between(first: Vector, last: Vector, frames: int) -> list[Vector]:
    """A movement at constant speed, without its first pose."""
    return [first + (last - first) * (i + 1) / frames for i in range(frames)]


SEARCHED: dict[str, Any] = {
    "root_px": (0.0, 0.0),
    "angles_deg": {},
    "squatting": False,
    "score": 0.0,
    "matches": 0,
}


def observation(mask: Mask | None = None, **said: Any) -> Observation:
    """A person with a silhouette, and anything else that may be said of them, of the search too."""
    seen = NOBODY if mask is None else mask
    search = {name: said.pop(name) for name in SEARCHED if name in said}
    given = {"box": box_of(seen) or Box(0, 0, 0, 0), "area_px": 0, **said}
    if search:
        given["search"] = Search(**SEARCHED | search)
    height, width = seen.shape
    return Observation(width=width, height=height, silhouette=pack(seen), **given)


def report(viewer: ViewerNumber, mask: Mask | None = None, **said: Any) -> View:
    """What a viewer says of a silhouette, with anything else that it may say of it or the frame."""
    seen = NOBODY if mask is None else mask
    names = [*Observation.__struct_fields__, *SEARCHED]
    person = {name: said.pop(name) for name in names if name in said}
    given = {"frame": 0, "captured_s": 0.0, "clock_s": 0.0, **said}
    return View(
        viewer=viewer,
        width=seen.shape[1],
        height=seen.shape[0],
        people=(observation(seen, **person),) if seen.any() or "box" in person else (),
        **given,
    )


def person_of(view: View) -> Observation:
    """The person whom a view shows."""
    assert view.person is not None
    return view.person


def changed(view: View, **said: Any) -> View:
    """The view with other things said of its person."""
    return with_person(view, msgspec.structs.replace(person_of(view), **said))
