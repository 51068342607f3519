"""Synthetic reports, merged once to compile and load everything before the first real ones."""

from collections.abc import Sequence
from typing import Final

import msgspec

from common.body.body import JOINT_NAMES, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.observation import Landmarks
from common.body.proportions import body_vector, thesis_bdp
from common.bus.instant import instant_of
from common.bus.messages import View, ViewerNumber, place_in_rig
from common.config.settings import Settings
from common.method import METHODS
from common.raster.kernel import draw_body, view_of
from common.raster.silhouette_report import pack, silhouette_view, unpack, with_person
from common.rig.camera import Rig, paper_rig, project
from integrator import merge, merge_state
from integrator.fit import visual_hull

VIEWERS: Final[tuple[ViewerNumber, ...]] = (1, 2)


def warm_up(settings: Settings, size: tuple[int, int]) -> None:
    """Merge reports of a standing person, in a calibrated room and in another: three pairs, then
    one view alone.

    Args:
        settings: The run's settings.
        size: (width, height) of the working picture.
    """
    known = _rig(size)
    for rig in (known, None):
        state = merge_state.init(rig, 1.0, settings, METHODS[settings.mode])
        for index in range(4):
            shown = VIEWERS if index < 3 else VIEWERS[:1]
            views = {viewer: _view(viewer, index, size, known) for viewer in shown}
            state, _, _ = merge.step(state, instant_of(views, len(VIEWERS)))
    _clear(known, [_view(viewer, 0, size, known) for viewer in VIEWERS])


def _clear(rig: Rig, views: Sequence[View]) -> None:
    """Clear silhouettes, one of them with clutter."""
    person, other = (person for view in views for person in view.people)
    clutter = unpack(person)
    clutter[: len(clutter) // 20, : len(clutter) // 20] = True
    visual_hull.cleaned(rig, (msgspec.structs.replace(person, silhouette=pack(clutter)), other))


def _rig(size: tuple[int, int]) -> Rig:
    return paper_rig(size, (1.25 * size[0],) * 2, (4.5, 4.5))


def _view(viewer: ViewerNumber, index: int, size: tuple[int, int], rig: Rig) -> View:
    pose = rest_pose()
    pose[POSE_INDEX["y"]] = 1.0
    camera, body = rig.cameras[place_in_rig(viewer)], body_vector(thesis_bdp(1.75))
    mask = draw_body(body, pose, view_of(camera), size)
    view = silhouette_view(viewer, mask, index, float(index))
    places_px = project(camera, joints(body, pose)).tolist()
    shown = Landmarks(tuple((x, y) for x, y in places_px), (0.9,) * len(JOINT_NAMES))
    (person,) = view.people
    return with_person(view, msgspec.structs.replace(person, landmarks=shown))
