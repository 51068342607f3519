"""A loop of one's own over images: the bodies of `tritrack track`, and what it is refused for."""

import doctest
from collections.abc import Iterator
from itertools import count
from operator import attrgetter
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from spoiling import copied, refilmed

import runtime.steps.tracker
from common.body.body import JOINT_NAMES
from common.config.part_settings import CameraSettings, SettingsError
from common.config.settings import Settings
from common.rig.rig_file import CalibrationError, load_rig
from common.video.pictures import Image
from runtime.offline.lockstep import Decoders, track_clip
from runtime.overrides import overridden
from synth.scene.scene_clips import SceneSet, write_scenes
from tritrack import Body, Tracker

EMPTY = np.full((120, 160, 3), 90, np.uint8)


def pictures(video: Path) -> Iterator[Image]:
    capture = cv2.VideoCapture(str(video))
    while True:
        came, picture = capture.read()
        if not came:
            return
        yield np.asarray(picture, np.uint8)


@pytest.fixture(scope="module")
def films(clip: Path) -> list[list[Image]]:
    return [list(pictures(clip / f"cam{number}.avi")) for number in (1, 2)]


def tracked(clip: Path, films: list[list[Image]], folder: Path, views: Any) -> list[Body]:
    """By the command, with the first pictures as those of the empty room."""
    plates = [str(folder / f"empty{n + 1}.png") for n in range(len(films))]
    for plate, film in zip(plates, films, strict=True):
        cv2.imwrite(plate, film[0])
    cameras = {f"cam{n + 1}": CameraSettings(background=one) for n, one in enumerate(plates)}
    settings = Settings(clip=str(clip), cameras=cameras)
    with Decoders() as decoders:
        return list(track_clip(settings, decoders, views).bodies)


@pytest.mark.slow
@pytest.mark.parametrize(
    "views",
    [
        pytest.param((1, 2), id="both"),
        pytest.param((2,), id="cam2"),
    ],
)
def test_a_loop_gives_bit_for_bit_the_bodies_of_a_tracked_clip(
    clip: Path, films: list[list[Image]], tmp_path: Path, views: tuple[int, ...]
) -> None:
    used = [films[number - 1] for number in views]
    tracker = Tracker(
        clip.parent / "calibration.json",
        cameras=[f"cam{number}" for number in views],
        size="160x120",
        background=[film[0] for film in used],
    )
    assert tracker.posture is None
    got, names = list[Body](), set[str]()
    for instant in zip(*used, strict=True):
        got += tracker.step(list(instant))
        assert tracker.posture is not None
        assert tracker.posture.frame == len(got) - 1
        names.add(tracker.posture.name)
    assert got == tracked(clip, films, tmp_path, views)
    assert len(got) == 69
    if len(views) == 2:
        assert "raise_right_lateral" in names


@pytest.mark.slow
def test_a_loop_over_three_cameras_gives_the_bodies_of_a_tracked_clip_of_three(
    three_views: Path, tmp_path: Path
) -> None:
    clip = copied(three_views, tmp_path / "clip")
    refilmed(clip, lambda film: film[:45], cameras=(1, 2, 3))
    films = [list(pictures(clip / f"cam{number}.avi")) for number in (1, 2, 3)]
    tracker = Tracker(
        clip / "calibration.json", size="160x120", background=[film[0] for film in films]
    )
    assert tracker.cameras == ("cam1", "cam2", "cam3")
    instants = [tracker.step(list(images)) for images in zip(*films, strict=True)]
    assert [bodies[0] for bodies in instants] == tracked(clip, films, tmp_path, None)
    arrays = instants[-1].to_numpy()
    assert arrays["camera_names"].tolist() == ["cam1", "cam2", "cam3"]
    assert arrays["joints_px"].shape == (1, 3, 15, 2)
    assert np.isfinite(arrays["joints_m"]).all()


def test_without_pictures_of_the_empty_room_the_first_half_second_is_that(
    clip: Path, films: list[list[Image]]
) -> None:
    """Eight images at 15 a second, as of a live camera."""
    tracker = Tracker(clip.parent / "calibration.json", size="160x120")
    first = zip(*(film[:40] for film in films), strict=True)
    status = [tracker.step(list(instant))[0].status for instant in first]
    assert set(status[:8]) == {"empty"}
    assert status.count("tracking") > 20


@pytest.mark.slow
def test_without_a_background_a_person_who_is_there_from_the_first_image_is_followed(
    data_dir: Path,
) -> None:
    """Bit for bit as by the command, and near the true joints."""
    folder = data_dir / "dev" / "r07_t1_07_raise_both_lateral"
    settings = Settings(clip=str(folder), size="160x120")
    settings = overridden(settings, None, None, background="none")
    with Decoders() as decoders:
        of_the_command = list(track_clip(settings, decoders).bodies)
    films = [list(pictures(folder / f"cam{number}.avi")) for number in (1, 2)]
    tracker = Tracker(folder.parent / "calibration.json", size="160x120", background="none")
    got = [tracker.step(list(instant))[0] for instant in zip(*films, strict=True)]
    assert got == of_the_command
    with np.load(folder / "truth.npz") as truth:
        names = truth["joint_names"].tolist()
        true_m = truth["joints3d"][30:, [names.index(name) for name in JOINT_NAMES]]
    off_m = np.linalg.norm(np.array([body.joints_m for body in got[30:]]) - true_m, axis=-1)
    assert off_m.mean() < 0.05


def test_a_background_is_images_or_none_at_all() -> None:
    with pytest.raises(SettingsError, match=r'must be images, "none" or None, got \'room\''):
        Tracker(background="room")  # type: ignore[arg-type]


@pytest.mark.slow
def test_one_camera_needs_no_calibration_and_an_image_may_be_given_alone(
    films: list[list[Image]],
) -> None:
    tracker = Tracker(size="160x120", background=films[0][0])
    assert tracker.cameras == ("cam1",)
    bodies = [tracker.step(image, 0.1 * n)[0] for n, image in enumerate(films[0][:40])]
    assert [body.captured_s for body in bodies[:3]] == [0.0, 0.1, 0.2]
    assert bodies[-1].views == "1"
    assert bodies[-1].scale_source == "assumed"


def test_images_may_go_by_the_cameras_names_and_one_may_be_missing(
    clip: Path, films: list[list[Image]]
) -> None:
    tracker = Tracker(
        clip.parent / "calibration.json",
        size="160x120",
        background={"cam2": films[1][0], "cam1": films[0][0]},
    )
    for n in range(30):
        tracker.step({"cam2": films[1][n], "cam1": films[0][n]})
    assert tracker.step([films[0][30], films[1][30]])[0].views == "both"
    assert tracker.step({"cam1": films[0][31]})[0].views == "1"
    assert tracker.step([None, films[1][32]])[0].views == "2"


def test_bodies_become_the_arrays_of_a_run(clip: Path, films: list[list[Image]]) -> None:
    tracker = Tracker(
        clip.parent / "calibration.json", size="160x120", background=[f[0] for f in films]
    )
    for instant in zip(*(film[:30] for film in films), strict=True):
        bodies = tracker.step(list(instant))
    assert len(bodies) == 1
    arrays = bodies.to_numpy()
    assert arrays["joints_m"].shape == (1, 15, 3)
    assert arrays["joints_m"][0].tolist() == [list(joint) for joint in bodies[0].joints_m]
    assert arrays["frame"].tolist() == [29]


def test_pictures_may_be_larger_than_what_is_worked_on(
    clip: Path, films: list[list[Image]]
) -> None:
    rig = load_rig(clip.parent / "calibration.json")
    tracker = Tracker(rig, size="80x60", background=[film[0] for film in films])
    body = tracker.step([film[0] for film in films])[0]
    assert body.status == "empty"
    for instant in zip(*(film[1:30] for film in films), strict=True):
        body = tracker.step(list(instant))[0]
    assert np.array(body.joints_px).max(axis=(1, 2)).tolist() < [80.0, 80.0]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"size": "big"}, "size must look like 160x120"),
        ({"mode": "thesis"}, "mode must be default or paper"),
        ({"landmarks": "mediapipe"}, "landmarks must be own or none"),
        ({"rate_hz": 0.0}, "rate_hz must be from 0 to 1000"),
        ({"stature_m": 17.5}, "stature_m must be from 0.5 to 2.6"),
        ({"cameras": ("left", "right")}, "several cameras need a calibration"),
        ({"cameras": "left"}, r"cameras is a list of names: \['left'\]"),
        ({"cameras": ("left", "left")}, "cameras names 'left' twice"),
        ({"size": (320, 240)}, r"size must look like 160x120, got '\(320, 240\)'"),
    ],
)
def test_what_no_loop_could_mean_is_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(SettingsError, match=said):
        Tracker(**given)


def test_a_camera_that_the_calibration_has_not_is_refused(clip: Path) -> None:
    with pytest.raises(CalibrationError, match=r"has no camera 'left'; it has cam1, cam2"):
        Tracker(clip.parent / "calibration.json", cameras=["left"])


@pytest.mark.parametrize(
    ("images", "said"),
    [
        ([EMPTY, EMPTY], r"2 images for 1 cameras \(cam1\)"),
        ({"left": EMPTY}, "there is no camera 'left': there is cam1"),
        ([None], "camera cam1 gives no image: the first instant needs one of each"),
        (None, "camera cam1 gives no image: the first instant needs one of each"),
        ((False, None), r"2 images for 1 cameras"),
        ([(True, EMPTY)], r"cam1: an image is an array .* take the second of both, read\(\)\[1\]"),
        (["cam1.png"], r"cam1: an image is an array \(H, W, 3\) of uint8, got str"),
        ("cam1.png", "images are one array, a list of them or a dict by camera, got str"),
        (iter([EMPTY]), "a list of them or a dict by camera, got list_iterator"),
        (EMPTY.astype(np.float32), r"this is \(120, 160, 3\) of float32"),
        (EMPTY[..., 0], r"an image is an array \(H, W, 3\) .* this is \(120, 160\) of uint8"),
        (EMPTY[..., :2], r"blue, green, red; this is \(120, 160, 2\) of uint8"),
        (EMPTY[:0], r"this is \(0, 160, 3\) of uint8"),
    ],
    ids=range(13),
)
def test_what_is_no_image_is_refused(images: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Tracker(size="160x120", background=EMPTY).step(images)


def test_a_background_of_another_shape_or_none_of_one_camera_is_refused(
    clip: Path, films: list[list[Image]]
) -> None:
    first = [film[0] for film in films]
    rig = clip.parent / "calibration.json"
    tracker = Tracker(rig, size="160x120", background=[first[0], first[1][:100]])
    with pytest.raises(ValueError, match="the background of camera cam2 is of another shape"):
        tracker.step(first)
    with pytest.raises(ValueError, match="camera cam1 has no background"):
        Tracker(rig, size="160x120", background={"cam2": first[1]}).step(first)


def test_images_keep_their_size_and_time_goes_on() -> None:
    tracker = Tracker(size="160x120", background=EMPTY)
    tracker.step(EMPTY, 5.0)
    with pytest.raises(ValueError, match=r"captured_s must go on: 5.0 came after 5.0"):
        tracker.step(EMPTY, 5.0)
    with pytest.raises(ValueError, match="cam1 gives 160x100 pixels, it gave 160x120"):
        tracker.step(EMPTY[:100], 6.0)
    assert tracker.step(EMPTY, 6.0)[0].captured_s == 6.0


class FrameCache:
    """Images that all come in the same arrays, as `capture.read(image)` gives them."""

    def __init__(self, films: list[list[Image]]) -> None:
        """Nothing read yet."""
        self._films = films
        self.images = [np.zeros_like(film[0]) for film in films]

    def read(self, n: int) -> list[Image]:
        for image, film in zip(self.images, self._films, strict=True):
            image[:] = film[n]
        return self.images


@pytest.mark.slow
@pytest.mark.parametrize("learns", [True, False], ids=["learnt", "given"])
def test_a_program_may_read_all_images_into_the_same_arrays(
    clip: Path, films: list[list[Image]], learns: bool
) -> None:
    """The last picture and those of the empty room are remembered, not where they came in."""
    rig, got = load_rig(clip.parent / "calibration.json"), []
    for frame_cache in (FrameCache(films), None):
        plates = [film[0].copy() for film in films]
        tracker = Tracker(rig, size="160x120", background=None if learns else plates)
        for plate in plates:
            plate[:] = 0
        bodies = list[Body]()
        for n in range(30):
            bodies += tracker.step(
                frame_cache.read(n) if frame_cache else [film[n] for film in films]
            )
        got.append(bodies)
    assert got[0] == got[1]
    assert got[0][-1].views == "both"


@pytest.fixture(scope="module")
def uninterrupted(clip: Path, films: list[list[Image]]) -> list[Body]:
    """Of the first 24 instants."""
    whole = Tracker(load_rig(clip.parent / "calibration.json"), size="160x120")
    return [whole.step(instant)[0] for instant in list(zip(*films, strict=True))[:24]]


@pytest.mark.slow
@pytest.mark.parametrize("stage", ["looked", "joined", "recognizer.step", "viewer_of"])
def test_an_instant_that_is_interrupted_may_be_given_again(
    clip: Path,
    films: list[list[Image]],
    uninterrupted: list[Body],
    stage: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is as if it had never come, wherever Ctrl-C met it, learning too."""
    rig, instants = load_rig(clip.parent / "calibration.json"), list(zip(*films, strict=True))[:24]
    met = attrgetter(stage)(runtime.steps.tracker)
    turns = count()

    def interrupted(*given: Any) -> Any:
        done = met(*given)
        if next(turns) % 3 == 1:
            raise KeyboardInterrupt
        return done

    monkeypatch.setattr(f"runtime.steps.tracker.{stage}", interrupted)
    tracker, got, again = Tracker(rig, size="160x120"), list[Body](), 0
    while len(got) < len(instants) and again < 100:
        try:
            got += tracker.step(instants[len(got)])
        except KeyboardInterrupt:
            again += 1
    assert again > 0
    assert got == uninterrupted


def test_a_camera_that_is_away_at_first_keeps_the_other_from_nothing(
    clip: Path, films: list[list[Image]]
) -> None:
    """Each learns its own background; pictures of it are not heaped up meanwhile."""
    tracker = Tracker(clip.parent / "calibration.json", size="160x120")
    tracker.step([films[0][0], films[1][0]])
    bodies = [tracker.step([film, None])[0] for film in films[0][1:40]]
    assert {body.status for body in bodies[:7]} == {"empty"}
    assert (bodies[-1].status, bodies[-1].views) == ("tracking", "1")


def test_a_picture_of_another_shape_is_refused_and_costs_nothing() -> None:
    tracker = Tracker(size="160x120", background=EMPTY)
    with pytest.raises(ValueError, match="cam1 is of another shape than its images"):
        tracker.step(EMPTY[:90])
    assert tracker.step(EMPTY)[0].frame == 0


def test_its_example_is_true() -> None:
    failed, tried = doctest.testmod(runtime.steps.tracker)
    assert (failed, tried > 4) == (0, True)


@pytest.mark.slow
def test_everyone_is_followed_in_a_loop_with_numbers_and_postures(tmp_path: Path) -> None:
    """The bodies of `tritrack track --people all`, bit for bit; each has a posture."""
    folder = tmp_path / "clips"
    (scene,) = write_scenes(folder, SceneSet(2, 3.0, seed=11), (160, 120))
    settings = overridden(Settings(clip=str(scene), size="160x120"), None, None, people="all")
    empty = [next(pictures(scene / f"cam{n}.avi")) for n in (1, 2)]
    named = {f"cam{n}": CameraSettings(background=str(tmp_path / f"{n}.png")) for n in (1, 2)}
    for n, picture in zip((1, 2), empty, strict=True):
        cv2.imwrite(str(tmp_path / f"{n}.png"), picture)
    with Decoders() as decoders:
        due = list(track_clip(msgspec.structs.replace(settings, cameras=named), decoders).bodies)
    tracker = Tracker(folder / "calibration.json", size="160x120", background=empty, people="all")
    found: list[Body] = []
    films = [pictures(scene / f"cam{n}.avi") for n in (1, 2)]
    for n, images in enumerate(zip(*films, strict=True)):
        bodies = tracker.step(list(images), n / 15.0)
        assert [one.person for one in tracker.postures] == [body.person for body in bodies]
        found += bodies
    assert [body.joints_m for body in found] == [body.joints_m for body in due]
    assert {body.person for body in found} == {0, 1, 2}


def test_everyone_takes_a_calibration_and_is_a_word() -> None:
    with pytest.raises(SettingsError, match="to follow everyone takes a calibration"):
        Tracker(people="all")
    with pytest.raises(SettingsError, match='people must be 1 or "all", got 2'):
        Tracker(people=2)  # type: ignore[arg-type]
