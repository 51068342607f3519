"""tritrack in a program's own loop: images in, bodies out, in this process."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, Literal, NamedTuple

import numpy as np

from common.bus.messages import Body, Guide, Posture, ViewerNumber
from common.config.part_settings import BodySettings, SettingsError, SilhouetteSettings
from common.config.picture_size import size_of
from common.method import METHODS
from common.rig.camera import Rig
from common.video.clip_facts import Clip, camera_names, uprights_of, whole_rig
from common.video.pictures import Image
from integrator import merge_state
from integrator.frame_numbers import FrameTimes
from integrator.live_rig.live_calibration import LiveCalibration
from integrator.live_rig.rig_solver import SolverAtOnce
from integrator.merge_state import Start
from integrator.people import recognition
from recognizer import __main__ as recognizer
from recognizer import everyone
from runtime.steps.loop_backgrounds import Learns, empty_of, is_enough, plates_of
from runtime.steps.loop_bodies import Bodies
from runtime.steps.loop_cameras import cameras_of, clip_of
from runtime.steps.loop_images import Images, by_viewer, picture_of
from runtime.steps.loop_settings import People, kind_of, settings_of
from runtime.steps.one_thread import one_thread
from runtime.steps.together import joined, looked, viewer_of
from viewer import track
from viewer.background.background import Background, learn, unknown
from viewer.captured_frame import CapturedFrame

BOUND: Final = "320x240"
"""Default size of the working picture: README's figures are at this size."""
RATE_HZ: Final = 15.0
LARGEST_RATE_HZ: Final = 1000.0


class _Going(NamedTuple):
    """The state between instants."""

    clip: Clip
    learns: Learns
    """By camera whose background is still being learnt."""
    viewers: dict[ViewerNumber, track.State]
    """By camera whose background is known."""
    integrator: recognition.State
    calibration: LiveCalibration
    naming: everyone.State[recognizer.State]
    guide: Guide | None = None
    postures: tuple[Posture, ...] = ()
    instants: int = 0
    last_s: float | None = None


class Tracker:
    """Tracks one person in the images of one camera, or of two to eight calibrated ones.

    The steps are those of `tritrack track`: calibrated clips give the same bodies, bit for bit,
    where both get pictures of the empty room. There is no other process, no bus, no file.

    Examples:
        >>> import numpy as np
        >>> empty = np.full((120, 160, 3), 90, np.uint8)
        >>> tracker = Tracker(size="160x120", background=empty)
        >>> bodies = tracker.step(empty, captured_s=0.0)
        >>> bodies[0].status
        'empty'
        >>> bodies.to_numpy()["joints_m"].shape
        (1, 15, 3)
    """

    def __init__(
        self,
        calibration: str | Path | Rig | None = None,
        *,
        cameras: Sequence[str] = (),
        size: str = BOUND,
        mode: Literal["default", "paper"] = "default",
        landmarks: Literal["own", "none"] = "own",
        people: People = 1,
        background: Images | Literal["none"] | None = None,
        rate_hz: float = RATE_HZ,
        stature_m: float = BodySettings().stature_m,
    ) -> None:
        """Nothing seen yet.

        Args:
            calibration: Path or content of a `calibration.json`; one camera can do without.
            cameras: Names of the cameras that give images, in order; all of the calibration's where
                empty, or one, `cam1`, without a calibration.
            size: Bound of the working picture, width x height, pixels.
            mode: As `--mode`.
            landmarks: Whether the landmark network is used.
            people: 1: one person is followed; "all": everyone, with numbers from 1 on as
                `Body.person`; it takes a calibration.
            background: Images of the empty room, in the form of `step`'s; None: it is learnt from
                the first half second of images, as for a live camera, without a person; "none":
                people are seen by the landmark network alone.
            rate_hz: Approximate rate of each camera, Hz, also where `captured_s` is given.
            stature_m: The person's stature, where no calibration gives the scale.

        Raises:
            CalibrationError: When the calibration cannot be used.
            SettingsError: When anything else is out of bounds, or not supported in a program's own
                loop.
            ValueError: When `background` lacks an image of a camera. Both errors above are
                ValueErrors.
        """
        looks = SilhouetteSettings(background=kind_of(background))
        self._settings = settings_of(size, mode, landmarks, people, stature_m, looks)
        self._rate_hz = float(rate_hz)
        if not 0.0 < self._rate_hz <= LARGEST_RATE_HZ:
            raise SettingsError(f"rate_hz must be from 0 to {LARGEST_RATE_HZ:g}, got {rate_hz}")
        self._cameras = cameras_of(calibration, cameras)
        if mode == "paper" and len(self._cameras.numbers) > 2:
            raise SettingsError("the paper's mode is for two cameras: name them in cameras")
        if people == "all" and self._cameras.rig is None:
            raise SettingsError("to follow everyone takes a calibration: name it")
        numbers = self._cameras.numbers
        self._plates = None
        if background is not None and not isinstance(background, str):
            self._plates = plates_of(background, numbers)
        self._going: _Going | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras, in the order of the images."""
        return tuple(self._cameras.numbers)

    @property
    def posture(self) -> Posture | None:
        """The posture of the first person after the last step; None before the first."""
        return next(iter(self.postures), None)

    @property
    def postures(self) -> tuple[Posture, ...]:
        """The postures after the last step, of each of its bodies."""
        return () if self._going is None else self._going.postures

    def step(self, images: Images, captured_s: float | None = None) -> Bodies:
        """One instant: the image of each camera in, its bodies out.

        Images are copied. A refused or interrupted instant changes nothing.

        Args:
            images: (H, W, 3) uint8, blue, green, red; always of the same size. None where a camera
                has none now; the first instant needs one of each.
            captured_s: Capture time, seconds on any clock; None: derived from `rate_hz`.

        Raises:
            ValueError: When an image is no such array, or has another size than before, when there
                is none, or when time does not increase.
            CalibrationError: When the calibration belongs to pictures of another shape.
        """
        given, going = by_viewer(images, self._cameras.numbers), self._going
        self._refuse_too_few(given)
        with one_thread():
            going = going or self._begun(given)
            now_s = going.instants / self._rate_hz if captured_s is None else float(captured_s)
            _refuse_what_does_not_go_on(going, given, now_s)
            heard = going.calibration.looking
            try:
                self._going, bodies = self._stepped(going, given, now_s)
            except BaseException:  # an interrupted instant changes nothing
                going.calibration.looking = heard
                raise
        return Bodies(bodies, camera_names(self._going.clip))

    def _refuse_too_few(self, given: Mapping[ViewerNumber, Image]) -> None:
        missing = [name for name, n in self._cameras.numbers.items() if n not in given]
        if self._going is None and missing:
            raise ValueError(
                f"camera {missing[0]} gives no image: the first instant needs one of each camera"
            )
        if not given:
            raise ValueError("no camera gives an image: leave the instant out, or end at it")

    def _begun(self, given: Mapping[ViewerNumber, Image]) -> _Going:
        """The views at the working size, and the initial states."""
        settings, period_s = self._settings, 1.0 / self._rate_hz
        sizes = {n: (image.shape[1], image.shape[0]) for n, image in given.items()}
        clip = clip_of(self._cameras, sizes, size_of(settings.size), self._rate_hz)
        alone, times = len(clip.views) == 1, FrameTimes(period_s, counts=True)
        start = Start(alone, None, times=times, uprights=uprights_of(clip))
        method = METHODS[settings.mode]
        state = merge_state.init(whole_rig(clip), period_s, settings, method, start)
        naming = recognizer.init(recognizer.model_of(settings), settings.recognizer.window_frames)
        backgrounds = self._backgrounds(clip, given)
        viewers = {
            view.number: viewer_of(view, clip, settings, method, backgrounds[view.number])
            for view in clip.views
            if backgrounds
        }
        calibration = LiveCalibration(state, looks=False, solver=SolverAtOnce())
        learns: Learns = {} if viewers else {view.number: () for view in clip.views}
        streams = everyone.init(naming)
        return _Going(clip, learns, viewers, recognition.State(state), calibration, streams)

    def _backgrounds(
        self, clip: Clip, given: Mapping[ViewerNumber, Image]
    ) -> dict[ViewerNumber, Background]:
        """The backgrounds that are known before any step."""
        if self._settings.silhouette.background == "none":
            return {v.number: unknown(picture_of(given[v.number], v)) for v in clip.views}
        if self._plates is None:
            return {}
        return {number: learn(empty) for number, empty in empty_of(self._plates, clip).items()}

    def _stepped(
        self, going: _Going, given: Mapping[ViewerNumber, Image], now_s: float
    ) -> tuple[_Going, tuple[Body, ...]]:
        frames: dict[ViewerNumber, CapturedFrame] = {}
        for view in going.clip.views:
            if view.number in given:
                picture, count = picture_of(given[view.number], view), going.instants
                frame = CapturedFrame(count, now_s, now_s, picture, upright=view.upright)
                frames[view.number] = frame
        known = {n: frame for n, frame in frames.items() if n in going.viewers}
        viewers, reports = looked(going.viewers, known, going.guide)
        going = going._replace(viewers=viewers)
        for number in frames.keys() - known.keys():
            reports[number] = track.without_person(number, frames[number])
            going = self._learnt(going, number, frames[number].picture)
        integrator, merged = joined(going.integrator, reports, going.calibration)
        naming, postures = going.naming, list[Posture]()
        for body in merged.bodies:
            naming, posture = everyone.step(naming, body, recognizer.step)
            postures.append(posture)
        going = going._replace(integrator=integrator, guide=merged.guide, naming=naming)
        going = going._replace(postures=tuple(postures))
        after = going._replace(instants=going.instants + 1, last_s=now_s)
        return after, merged.bodies

    def _learnt(self, going: _Going, number: ViewerNumber, picture: Image) -> _Going:
        """The state with one more picture of a camera's empty room, and its viewer once there
        are enough."""
        (view,) = (view for view in going.clip.views if view.number == number)
        empty = (*going.learns[number], picture)
        if not is_enough(empty, view, self._settings.silhouette.empty_s):
            return going._replace(learns={**going.learns, number: empty})
        learns = {n: own for n, own in going.learns.items() if n != number}
        settings = self._settings
        begun = viewer_of(view, going.clip, settings, METHODS[settings.mode], learn(empty))
        return going._replace(learns=learns, viewers={**going.viewers, number: begun})


def _refuse_what_does_not_go_on(
    going: _Going, given: Mapping[ViewerNumber, Image], now_s: float
) -> None:
    if not np.isfinite(now_s) or (going.last_s is not None and now_s <= going.last_s):
        raise ValueError(f"captured_s must go on: {now_s} came after {going.last_s}")
    for view in going.clip.views:
        image = given.get(view.number)
        if image is not None and (image.shape[1], image.shape[0]) != view.source_size:
            wide, high = view.source_size
            raise ValueError(
                f"camera {view.source} gives {image.shape[1]}x{image.shape[0]} pixels, it gave "
                f"{wide}x{high}: begin anew with another Tracker"
            )
