"""tritrack in a loop of one's own: images in, bodies out, in this process."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

import msgspec
import numpy as np
from threadpoolctl import ThreadpoolController

from common.bus.messages import Body, Guide, Posture, Report, ViewerNumber
from common.config.part_settings import BodySettings
from common.config.picture_size import size_of
from common.config.settings import Settings
from common.config.settings_error import SettingsError
from common.method import METHODS, Mode
from common.rig.camera import Rig
from common.video.clip_facts import Clip, both_cameras, uprights_of
from common.video.clips import SAME_ASPECT
from common.video.pictures import Image
from common.video.reduction import reduced
from integrator import merge_state
from integrator.frame_numbers import FrameTimes
from integrator.live_rig.live_calibration import LiveCalibration
from integrator.live_rig.rig_solver import SolverAtOnce
from integrator.merge_state import Start
from recognizer import __main__ as recognizer
from runtime.steps.loop_cameras import cameras_of, clip_of
from runtime.steps.loop_images import Images, by_viewer
from runtime.steps.together import joined, looked
from runtime.store.pose_arrays import poses
from viewer import track
from viewer.background.background import learn
from viewer.captured_frame import CapturedFrame

BOUND: Final = "320x240"
"""Of the working picture: README's figures are at this size."""
RATE_HZ: Final = 15.0
LARGEST_RATE_HZ: Final = 1000.0


class Bodies(msgspec.Struct, frozen=True):
    """The bodies of one instant, to be gone through."""

    people: tuple[Body, ...]

    def __iter__(self) -> Iterator[Body]:
        """Body by body."""
        return iter(self.people)

    def __len__(self) -> int:
        """How many there are; who is not seen is one, of status `empty` or `lost`."""
        return len(self.people)

    def __getitem__(self, place: int) -> Body:
        """One of them."""
        return self.people[place]

    def to_numpy(self) -> dict[str, Any]:
        """As the arrays of `poses.npz`, a row a body: `joints_m` (n, 15, 3) and so on."""
        return poses(self.people)


class _Going(NamedTuple):
    """What is remembered from one instant to the next."""

    viewers: dict[ViewerNumber, track.State]
    """None of them while the backgrounds are learnt."""
    integrator: merge_state.State
    guide: Guide | None = None


class Tracker:
    """Follows one person in the images of one camera, or of two that are calibrated.

    The steps are those of `tritrack track`: calibrated clips give the same bodies, bit for bit,
    where both are given pictures of the empty room. There is no other process, no bus, no file.

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
        background: Images | None = None,
        rate_hz: float = RATE_HZ,
        stature_m: float = BodySettings().stature_m,
    ) -> None:
        """Nothing seen yet.

        Args:
            calibration: A `calibration.json`, or what one holds; one camera can do without.
            cameras: Names of those that give images, in their order; all of the calibration's
                when empty, or one, `cam1`, where there is none.
            size: Bound of the working picture, width x height, pixels.
            mode: As `--mode`.
            landmarks: Whether the network of landmarks looks at the pictures.
            background: Of the empty room, as images are given to `step`; None: it is learnt from
                the first half second of images, as of a live camera. Nobody may be seen in these.
            rate_hz: Images a second of each camera.
            stature_m: Of the person, where no calibration gives the scale.

        Raises:
            CalibrationError: When the calibration cannot be used.
            SettingsError: When anything else is out of bounds, or not for a loop of one's own.
        """
        self._settings = _settings(size, mode, landmarks, stature_m)
        if not 0.0 < rate_hz <= LARGEST_RATE_HZ:
            raise SettingsError(f"rate_hz must be from 0 to {LARGEST_RATE_HZ:g}, got {rate_hz}")
        self._rate_hz = rate_hz
        self._cameras = cameras_of(calibration, cameras)
        self._plates = None if background is None else by_viewer(background, self._cameras.numbers)
        self._going: _Going | None = None
        self._clip: Clip | None = None
        self._learns: dict[ViewerNumber, list[Image]] = {
            n: [] for n in self._cameras.numbers.values()
        }
        self._count = 0
        self._last_s: float | None = None
        self._posture: Posture | None = None
        self._naming: recognizer.State | None = None
        self._threads = ThreadpoolController()

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras, in the order in which images are given."""
        return tuple(self._cameras.numbers)

    @property
    def posture(self) -> Posture | None:
        """What the body is doing, by the last step; None before the first."""
        return self._posture

    def step(self, images: Images, captured_s: float | None = None) -> Bodies:
        """One instant: the image of each camera, and the bodies that they show.

        Args:
            images: (H, W, 3) uint8, blue, green, red; always of the same size.
            captured_s: When they were taken, seconds on any clock; None: `rate_hz` tells.

        Raises:
            ValueError: When an image is no such array, or another size than before, when there is
                none, or when time does not go on.
            CalibrationError: When the calibration is of pictures of another shape.
        """
        given = {
            n: image
            for n, image in by_viewer(images, self._cameras.numbers).items()
            if image is not None
        }
        now_s = self._count / self._rate_hz if captured_s is None else float(captured_s)
        self._refuse_what_does_not_go_on(given, now_s)
        with self._threads.limit(limits=1):
            if self._going is None:
                self._clip, self._going = self._begun(given)
            body = self._stepped(self._going, given, now_s)
            if self._naming is None:
                model = recognizer.model_of(self._settings)
                self._naming = recognizer.init(model, self._settings.recognizer.window_frames)
            self._naming, self._posture = recognizer.step(self._naming, body)
        self._count, self._last_s = self._count + 1, now_s
        return Bodies((body,))

    def _stepped(self, going: _Going, given: dict[ViewerNumber, Image], now_s: float) -> Body:
        assert self._clip is not None
        views = {view.number: view for view in self._clip.views}
        frames = {
            n: CapturedFrame(
                self._count,
                now_s,
                now_s,
                reduced(image, views[n].size, views[n].quarters),
                upright=views[n].upright,
            )
            for n, image in given.items()
        }
        reports: dict[int, Report]
        if going.viewers:
            viewers, reports = looked(going.viewers, frames, going.guide)
        else:
            viewers = self._learnt(frames)
            reports = {n: track.without_person(n, frame) for n, frame in frames.items()}
        integrator, body, guide = joined(going.integrator, reports, self._calibration)
        self._going = _Going(viewers, integrator, guide)
        return body

    def _begun(self, given: dict[ViewerNumber, Image]) -> tuple[Clip, _Going]:
        """The views as they are worked on, and steps that have seen nothing."""
        sizes = {n: (image.shape[1], image.shape[0]) for n, image in given.items()}
        clip = clip_of(self._cameras, sizes, size_of(self._settings.size), self._rate_hz)
        method, alone = METHODS[self._settings.mode], len(clip.views) == 1
        times = FrameTimes(1.0 / self._rate_hz, counts=True)
        start = Start(alone, None, times=times, uprights=uprights_of(clip))
        rig = both_cameras(clip)
        state = merge_state.init(rig, 1.0 / self._rate_hz, self._settings, method, start)
        self._calibration = LiveCalibration(state, looks=False, solver=SolverAtOnce())
        self._clip = clip
        return clip, _Going(self._with_plates(clip), state)

    def _with_plates(self, clip: Clip) -> dict[ViewerNumber, track.State]:
        """Viewers that know their backgrounds, where pictures of these were given."""
        plates = self._plates
        if plates is None:
            return {}
        for view in clip.views:
            plate = plates[view.number]
            if plate is None:
                raise ValueError(f"camera {view.source} has no background: give one of each camera")
            aspect = plate.shape[1] * view.source_size[1] / (plate.shape[0] * view.source_size[0])
            if abs(aspect - 1.0) > SAME_ASPECT:
                raise ValueError(
                    f"the background of camera {view.source} is of another shape than its images: "
                    "take an empty image of the same camera, uncropped"
                )
            self._learns[view.number] = [reduced(plate, view.size, view.quarters)]
        return self._viewers(clip)

    def _learnt(self, frames: dict[ViewerNumber, CapturedFrame]) -> dict[ViewerNumber, track.State]:
        """Viewers that know their backgrounds, once enough was seen of each; none before."""
        clip = self._clip
        assert clip is not None
        for number, frame in frames.items():
            self._learns[number].append(frame.picture)
        due = {
            view.number: view.frames_in(self._settings.silhouette.empty_s) for view in clip.views
        }
        if any(len(self._learns[number]) < count for number, count in due.items()):
            return {}
        return self._viewers(clip)

    def _viewers(self, clip: Clip) -> dict[ViewerNumber, track.State]:
        settings, rig = self._settings, both_cameras(clip)
        method, alone = METHODS[settings.mode], len(clip.views) == 1
        viewers: dict[ViewerNumber, track.State] = {}
        for view in clip.views:
            camera = None if rig is None else rig.cameras[view.number - 1]
            setup = track.Setup(view.number, camera, settings, method, alone)
            viewers[view.number] = track.init(setup, learn(self._learns.pop(view.number)))
        return viewers

    def _refuse_what_does_not_go_on(self, given: dict[ViewerNumber, Image], now_s: float) -> None:
        if not given or (self._clip is None and len(given) < len(self._cameras.numbers)):
            raise ValueError("an instant needs an image, the first one of each camera")
        if not np.isfinite(now_s) or (self._last_s is not None and now_s <= self._last_s):
            raise ValueError(f"captured_s must go on: {now_s} came after {self._last_s}")
        for view in self._clip.views if self._clip is not None else ():
            image = given.get(view.number)
            if image is not None and (image.shape[1], image.shape[0]) != view.source_size:
                wide, high = view.source_size
                raise ValueError(
                    f"camera {view.source} gives {image.shape[1]}x{image.shape[0]} pixels, it gave "
                    f"{wide}x{high}: begin anew with another Tracker"
                )


def _settings(size: str, mode: Mode, landmarks: str, stature_m: float) -> Settings:
    if mode not in ("default", "paper"):
        raise SettingsError(f"mode must be default or paper in a loop of one's own, got {mode!r}")
    if landmarks not in ("own", "none"):
        raise SettingsError(f"landmarks must be own or none, got {landmarks!r}")
    try:
        body = BodySettings(stature_m=stature_m)
        return Settings(size=size, mode=mode, landmarks=landmarks, body=body)
    except ValueError as error:
        raise SettingsError(str(error)) from error
