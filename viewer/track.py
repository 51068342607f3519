"""One viewer's step: the stages of section 3 in their order."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.body.body import JOINT_NAMES
from common.body.observation import Box, Landmarks, Observation, Pixel
from common.bus.messages import Guide, View, ViewerNumber
from common.config.settings import Settings
from common.method import Method
from common.raster.silhouette_report import mask_of, with_person
from common.raster.similarity import Mask
from common.rig.camera import Camera
from common.video.pictures import Image
from viewer import camera_fault, landmark_step
from viewer.background import moved_camera
from viewer.background.background import Background
from viewer.background.moved_objects import Patch
from viewer.background.turned_picture import lens_of, turned_background
from viewer.captured_frame import CapturedFrame
from viewer.expected_body import due_in, expected_body, followed_px, moving_since_s
from viewer.landmarks.person_mask import LandmarkResult, Shown
from viewer.paper import pose_search
from viewer.people import worn_clothes
from viewer.people.known_people import forgotten, of_one
from viewer.people.observed_people import everyone
from viewer.people.openings import with_opening, with_openings
from viewer.room.silhouette_correction import corrected, is_trusted
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import Seen
from viewer.stick.standing_height import Standing
from viewer.stick.stick_report import with_stick

PELVIS: Final = JOINT_NAMES.index("pelvis")


class Setup(NamedTuple):
    """What a viewer knows before its first frame."""

    viewer: ViewerNumber
    camera: Camera | None
    """Calibrated, at the working size; None: there is no calibration."""
    settings: Settings
    method: Method
    """The departures from the print."""
    alone: bool = False
    """True for the only viewer of its run."""

    @property
    def is_placed(self) -> bool:
        """True: the integrator knows by places which of this view's people it follows; otherwise it
        takes the first."""
        return self.alone or self.camera is not None

    @property
    def searches(self) -> bool:
        """True: this viewer searches for the pose, angle by angle; otherwise the integrator
        reads it off the silhouettes, and this viewer only segments and measures."""
        proposed = self.method.proposals and self.is_placed
        return not (proposed or self.method.stick_lifting)


class State(NamedTuple):
    """A viewer's state between frames."""

    setup: Setup
    fault: camera_fault.State
    silhouette: silhouette.State
    coming: tuple[Patch, ...]
    """Later changes of the background, in the order of time."""
    search: pose_search.State
    standing: Standing | None
    """Height of the standing person; None: not known before."""
    landmarks: landmark_step.State = landmark_step.State()
    near_px: Pixel | None = None
    """Middle of the last silhouette, for frames without a guide's prediction."""
    moved: moved_camera.State | None = None
    """State of the search for a moved camera; None: it is off."""
    unsearched: Image | None = None
    """The last picture, while it is still to be searched for the camera's move."""


def init(
    setup: Setup,
    background: Background,
    *,
    patches: Sequence[Patch] = (),
    standing: Standing | None = None,
    somebody: Landmarks | None = None,
) -> State:
    """A viewer's state before its first frame.

    Args:
        setup: Number of the viewer and its method.
        background: The picture without people.
        patches: Changes of the background, where the whole video was examined before.
        standing: Height of the standing person, from the same examination.
        somebody: The person in the first frame, likewise; without it the largest region is
            followed.
    """
    return State(
        setup,
        camera_fault.init(background),
        silhouette.init(background, setup.settings.silhouette, setup.method),
        tuple(patches),
        pose_search.init(setup.viewer, setup.camera, setup.settings.search, setup.method),
        standing,
        landmark_step.State(of_one(somebody if setup.method.landmarks else None)),
        moved=_watched(setup, background, None),
    )


def with_background(state: State, background: Background) -> State:
    """The viewer with a new background: nothing of the old one is kept."""
    setup = state.setup
    return state._replace(
        fault=camera_fault.init(background),
        silhouette=silhouette.init(background, setup.settings.silhouette, setup.method),
        coming=(),
        moved=_watched(setup, background, state.moved),
    )


def _watched(
    setup: Setup, background: Background, before: moved_camera.State | None
) -> moved_camera.State | None:
    """The detector of a moved camera, where a rig may become wrong by that."""
    if not setup.method.follows_cameras or (setup.alone and setup.camera is None):
        return None
    high, wide = background.uncertain.shape
    begun = None if before is None else before.turn @ before.begun
    return moved_camera.init(background, lens_of(setup.camera, (wide, high)), begun)


def step(state: State, frame: CapturedFrame, guide: Guide | None) -> tuple[State, View]:
    """One frame: silhouette, opening posture, facing, position, arms, legs (P23).

    A picture that shows no scene (frozen, black, white) is reported and not processed.

    Args:
        state: The viewer's state.
        frame: The picture.
        guide: The integrator's guide after the frame before; None at the start.
    """
    return describe(*look(state, frame, guide), guide)


def look(state: State, frame: CapturedFrame, guide: Guide | None) -> tuple[State, View, Mask]:
    """The people of a frame, as a message, and the first one's mask (H, W).

    Args:
        state: The viewer's state.
        frame: The picture.
        guide: The integrator's guide after the frame before; None at the start.
    """
    state = _followed(state)
    was_seen = state.near_px is not None
    since_s = moving_since_s(guide, state.setup.viewer) if was_seen else None
    watched, fault = camera_fault.step(state.fault, frame.picture, frame.captured_s, since_s)
    state = state._replace(fault=watched)
    if fault:
        view = without_person(state.setup.viewer, frame)
        return state, msgspec.structs.replace(view, fault=fault), mask_of(view)
    state = _patched(state, frame.index)
    remembered, seen = silhouette.step(state.silhouette, frame.picture, _near_px(state, guide))
    setup, known, shown = state.setup, state.landmarks, Shown(LandmarkResult(None))
    if setup.method.landmarks:
        known, shown = landmark_step.step(
            known,
            frame,
            seen,
            setup.settings,
            alone=setup.alone,
            root_px=followed_px(guide, setup.viewer),
            due=due_in(guide, setup.viewer),
        )
    least_share = setup.settings.silhouette.min_height_share
    held = corrected(seen, shown.followed, least_share, shown.masks)
    if held.is_changed:
        remembered = silhouette.without_things(
            remembered, state.silhouette, frame.picture, held.things
        )
    seen = held.seen
    people = everyone(remembered, frame.picture, seen, shown, least_share)
    known_now, people = worn_clothes.step(known.people, people)
    known = known._replace(people=known_now)
    if people and people[0].track != known_now.followed and not setup.is_placed:
        people = ()
    view = _view_of(setup.viewer, frame, seen, people)
    if state.moved is not None:
        view = msgspec.structs.replace(view, shift=state.moved.shift)
    state = state._replace(
        silhouette=remembered,
        near_px=_middle_px(seen.box),
        landmarks=known,
        unsearched=None if state.moved is None else frame.picture,
    )
    return state, view, mask_of(view) if shown.others else seen.mask


def finished(state: State) -> State:
    """The state after what a frame's report does not wait for: the searches of its picture for
    people and for a move of the camera. Whenever it is called before the next step, that gives the
    same."""
    state = _followed(state)
    return state._replace(landmarks=landmark_step.searched(state.landmarks))


def describe(state: State, view: View, mask: Mask, guide: Guide | None) -> tuple[State, View]:
    """The result of `look`, completed with all measurements of its silhouette.

    Args:
        state: The viewer's state.
        view: From `look`.
        mask: (H, W) the silhouette.
        guide: The integrator's guide after the frame before; None at the start.
    """
    setup, search, person = state.setup, state.search, view.person
    if person is None:
        return state._replace(search=search._replace(found=None)), view
    view = with_person(view, msgspec.structs.replace(person, vote=search.vote))
    is_one = setup.settings.people == 1
    view = with_opening(view, mask, guide) if is_one else with_openings(view)
    person = view.people[0]
    if setup.method.stick_lifting or (guide is not None and guide.stick):
        known = expected_body(guide, setup.viewer)
        person = with_stick(person, mask, search.rotation, known, state.standing, setup.method)
    elif setup.searches and not (guide is not None and guide.proposes):
        search, person = pose_search.step(search, person, mask, guide)
    return state._replace(search=search), with_person(view, person)


def without_person(viewer: ViewerNumber, frame: CapturedFrame) -> View:
    """The report of a picture that is not processed."""
    nothing = np.zeros(frame.picture.shape[:2], np.bool_)
    return _view_of(viewer, frame, Seen(nothing, None, 0, 0, cut=False), ())


def _view_of(
    viewer: ViewerNumber, frame: CapturedFrame, seen: Seen, people: tuple[Observation, ...]
) -> View:
    """The message of a frame, its followed person's silhouette and its people."""
    height, width = seen.mask.shape
    return View(
        frame=frame.index,
        captured_s=frame.captured_s,
        clock_s=frame.clock_s,
        viewer=viewer,
        width=width,
        height=height,
        people=people,
        blobs=seen.blobs,
        next_s=frame.next_s,
        upright=frame.upright,
    )


def _followed(state: State) -> State:
    """The state with the background as seen after the camera was moved, by the last picture."""
    picture = state.unsearched
    if state.moved is None or picture is None:
        return state
    moved, is_new = moved_camera.step(state.moved, picture)
    state = state._replace(moved=moved, unsearched=None)
    if not is_new:
        return state
    background = turned_background(moved.first, moved.lens, moved.turn, picture)
    return state._replace(
        silhouette=silhouette.before(state.silhouette, background),
        landmarks=landmark_step.State(forgotten(state.landmarks.people)),
        near_px=None,
    )


def _patched(state: State, index: int) -> State:
    """The state with the changes of the background up to a frame."""
    due = [patch for patch in state.coming if patch.frame <= index]
    for patch in due:
        state = state._replace(silhouette=silhouette.patched(state.silhouette, patch))
    return state._replace(coming=state.coming[len(due) :]) if due else state


def _near_px(state: State, guide: Guide | None) -> Pixel | None:
    """The body's expected place: at its landmarks, by the guide, or in a single view its last."""
    landmarks = state.landmarks.known
    if landmarks is not None and is_trusted(landmarks):
        return landmarks.joints_px[PELVIS]
    known = expected_body(guide, state.setup.viewer)
    if known is not None:
        return known.root_px
    return state.near_px if state.setup.alone else None


def _middle_px(box: Box | None) -> Pixel | None:
    if box is None:
        return None
    return (box.left + box.right + 1) / 2, (box.top + box.bottom + 1) / 2
