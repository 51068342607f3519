"""Clips as users have them: complete, odd, and broken in every way that a folder can be."""

import json
import math
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest

from common.config.part_settings import CameraSettings, SilhouetteSettings
from common.config.settings import Settings
from common.rig.camera import paper_rig, project
from common.video.clip_facts import Act, Clip, ClipView, Meta, shortfall
from common.video.clip_sources import ClipError
from common.video.clips import find_calibration, meta_of, open_clip, probed
from common.video.decoding import Decoder
from common.video.pictures import Ending, Source, Undecodable, VideoInfo

SIZE = (320, 240)


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    with Decoder() as shared:
        yield shared


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A clip of two views, calibrated one folder up."""
    clip = tmp_path / "r01_walk"
    clip.mkdir()
    for number in (1, 2):
        film(clip / f"cam{number}.avi")
    calibrate(tmp_path / "calibration.json")
    return clip


def film(path: Path, frames: int = 12, size: tuple[int, int] = SIZE, fps: float = 15.0) -> str:
    """A video of its own: its grey level is the sum of its name's letters."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), fps, size)
    for _ in range(frames):
        writer.write(np.full((size[1], size[0], 3), 2 * sum(path.stem.encode()) % 256, np.uint8))
    writer.release()
    return str(path)


def calibrate(path: Path, size: tuple[int, int] = SIZE, names: tuple[str, ...] = ()) -> None:
    rig = paper_rig(size, (400.0, 420.0), (4.5, 4.0))
    cameras: list[dict[str, Any]] = [
        {"name": camera.name, "K": camera.K, "R": camera.R, "t": camera.t} for camera in rig.cameras
    ]
    if names:
        cameras = [
            {**cameras[0], "name": name, "t": (float(n), *cameras[0]["t"][1:])}
            for n, name in enumerate(names)
        ]
    path.write_text(json.dumps({"width": size[0], "height": size[1], "cameras": cameras}))


def tell(folder: Path, **facts: object) -> None:
    (folder / "meta.json").write_text(json.dumps(facts))


def opened(folder: Path, decoder: Decoder, **settings: Any) -> Clip:
    return open_clip(Settings(clip=str(folder), **settings), decoder)


def refusal(settings: Settings, decoder: Decoder) -> str:
    with pytest.raises(ClipError) as caught:
        open_clip(settings, decoder)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_folder_of_two_views_is_a_clip(folder: Path, decoder: Decoder) -> None:
    tell(folder, performer="r01", posture="squat", take=2, room=7, measures={"stature_m": 1.7})
    clip = opened(folder, decoder)
    assert (clip.name, clip.meta.performer, clip.meta.take) == ("r01_walk", "r01", 2)
    assert [(v.number, v.size, v.source_size, v.fps, v.frames) for v in clip.views] == [
        (1, (160, 120), SIZE, 15.0, 12),
        (2, (160, 120), SIZE, 15.0, 12),
    ]
    assert clip.warnings == ()


def test_the_calibration_is_scaled_to_the_working_picture(folder: Path, decoder: Decoder) -> None:
    """Half the picture, half the pixel coordinates: with the corner at 0, all of K halves."""
    rig = opened(folder, decoder).rig
    assert rig is not None
    full = paper_rig(SIZE, (400.0, 420.0), (4.5, 4.0))
    points_m = np.array([[0.3, 1.2, 0.4], [-0.5, 0.1, -0.2]])
    assert (rig.width, rig.height) == (160, 120)
    for small, large in zip(rig.cameras, full.cameras, strict=True):
        assert project(small, points_m) == pytest.approx(project(large, points_m) / 2)


def test_a_calibration_beside_the_videos_goes_before_the_parents(
    folder: Path, decoder: Decoder
) -> None:
    calibrate(folder / "calibration.json", names=("left", "right"))
    rig = opened(folder, decoder).rig
    assert rig is not None
    assert [camera.name for camera in rig.cameras] == ["left", "right"]


def test_two_of_several_cameras_are_taken_by_name(folder: Path, decoder: Decoder) -> None:
    calibrate(folder / "four.json", names=("a", "b", "c", "d"))
    settings = Settings(
        clip=str(folder),
        calibration=str(folder / "four.json"),
        cameras={
            "cam1": CameraSettings(calibrated_as="d"),
            "cam2": CameraSettings(calibrated_as="b"),
        },
    )
    rig = open_clip(settings, decoder).rig
    assert rig is not None
    assert [camera.name for camera in rig.cameras] == ["d", "b"]
    wrong = Settings(
        clip=str(folder),
        calibration=settings.calibration,
        cameras={"cam1": CameraSettings(calibrated_as="x")},
    )
    assert "no camera 'x'; it has a, b, c, d" in refusal(wrong, decoder)


def test_of_more_cameras_than_views_none_is_taken_by_its_place(
    folder: Path, decoder: Decoder
) -> None:
    calibrate(folder / "calibration.json", names=("a", "b", "c", "d"))
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "has 4 cameras (a, b, c, d): say which of them took view 1" in said
    assert "cameras.cam1.calibrated_as" in said
    calibrate(folder / "calibration.json", names=("cam3", "cam2", "cam1"))
    rig = opened(folder, decoder).rig
    assert rig is not None
    assert [camera.name for camera in rig.cameras] == ["cam1", "cam2"]


def test_a_calibrations_cameras_are_those_of_the_clips_names(
    folder: Path, decoder: Decoder
) -> None:
    """In whatever order it lists them; names of none of the clip's go by their place."""
    calibrate(folder / "calibration.json", names=("cam2", "cam1"))
    rig = opened(folder, decoder).rig
    assert rig is not None
    assert [camera.name for camera in rig.cameras] == ["cam1", "cam2"]
    calibrate(folder / "calibration.json", names=("left", "cam1"))
    rig = opened(folder, decoder).rig
    assert rig is not None
    assert [camera.name for camera in rig.cameras] == ["left", "cam1"]


def test_three_cameras_are_a_clip_of_three_views(folder: Path, decoder: Decoder) -> None:
    film(folder / "cam3.avi")
    calibrate(folder / "calibration.json", names=("c", "b", "a"))
    clip = opened(folder, decoder)
    assert [(view.number, view.name) for view in clip.views] == [
        (1, "cam1"),
        (2, "cam2"),
        (3, "cam3"),
    ]
    assert clip.rig is not None
    assert [camera.name for camera in clip.rig.cameras] == ["c", "b", "a"]
    some = open_clip(Settings(clip=str(folder)), decoder, (1, 3))
    assert some.rig is not None
    assert [camera.name for camera in some.rig.cameras] == ["c", "a"]
    calibrate(folder / "calibration.json", names=("c", "b"))
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "has 2 cameras, the clip has a view 3: calibrate all" in said


def test_a_missing_camera_is_let_go_where_it_is_not_asked_for(
    folder: Path, decoder: Decoder
) -> None:
    (folder / "cam2.avi").rename(folder / "cam3.avi")
    said = refusal(Settings(clip=str(folder)), decoder)
    assert (
        "has cam1.avi, cam3.avi and no cam2.*: add it; to track without it add --views 1,3" in said
    )
    calibrate(folder / "calibration.json", names=("cam1", "cam2", "cam3"))
    clip = open_clip(Settings(clip=str(folder)), decoder, (1, 3))
    assert clip.rig is not None
    assert [camera.name for camera in clip.rig.cameras] == ["cam1", "cam3"]


def test_one_video_makes_a_single_view_clip(folder: Path, decoder: Decoder) -> None:
    (folder / "cam1.avi").unlink()
    clip = open_clip(Settings(clip=str(folder)), decoder, (2,))
    assert [view.number for view in clip.views] == [2]
    assert clip.rig is not None
    assert [camera.name for camera in clip.rig.cameras] == ["cam2"]


def test_cameras_at_one_place_are_refused_unless_the_user_insists(
    folder: Path, decoder: Decoder
) -> None:
    """For every command alike: live runs and `track` open their clips here."""
    path = folder / "one_place.json"
    calibrate(path, names=("left", "right"))
    told = json.loads(path.read_text())
    told["cameras"][1]["t"] = told["cameras"][0]["t"]
    path.write_text(json.dumps(told))
    settings = Settings(clip=str(folder), calibration=str(path))
    assert "r01_walk: left and right stand at one place" in refusal(settings, decoder)
    insisted = msgspec.structs.replace(settings, trust_calibration=True)
    assert open_clip(insisted, decoder).rig is not None


def test_a_calibration_in_millimetres_is_refused(folder: Path, decoder: Decoder) -> None:
    told = json.loads((folder.parent / "calibration.json").read_text())
    for camera in told["cameras"]:
        camera["t"] = [1000 * each for each in camera["t"]]
    (folder / "calibration.json").write_text(json.dumps(told))
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "the cameras are 6021 m apart: is t in millimetres" in said


def test_a_video_under_two_names_is_no_pair(folder: Path, decoder: Decoder) -> None:
    shutil.copy(folder / "cam1.avi", folder / "cam2.avi")
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "views 1 and 2 are the same" in said
    assert len(open_clip(Settings(clip=str(folder)), decoder, (1,)).views) == 1


@pytest.mark.parametrize(
    ("name", "cure"),
    [
        ("", "add it"),
        ("cam_2.avi", "rename cam_2.avi to cam2.avi"),
        ("Cam2.MP4", "rename Cam2.MP4 to cam2.MP4"),
        ("notes2.txt", "add it"),
    ],
)
def test_one_of_two_videos_is_refused_with_the_other_ones_likely_name(
    folder: Path, decoder: Decoder, name: str, cure: str
) -> None:
    video = folder / "cam2.avi"
    if name:
        video.rename(folder / name)
    else:
        video.unlink()
    said = refusal(Settings(clip=str(folder)), decoder)
    assert f"has cam1.avi and no cam2.*: {cure}; to track by one camera alone add --views 1" in said
    assert len(open_clip(Settings(clip=str(folder)), decoder, (1,)).views) == 1


def test_the_missing_one_may_be_the_first(folder: Path, decoder: Decoder) -> None:
    (folder / "cam1.avi").rename(folder / "1.avi")
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "has cam2.avi and no cam1.*: rename 1.avi to cam1.avi" in said
    assert "--views 2" in said


def test_files_under_any_name_are_taken_from_the_settings(tmp_path: Path, decoder: Decoder) -> None:
    settings = Settings(
        cameras={
            "cam1": CameraSettings(source=film(tmp_path / "front.avi")),
            "cam2": CameraSettings(source=film(tmp_path / "side.avi")),
        },
    )
    clip = open_clip(settings, decoder)
    assert [view.source for view in clip.views] == [
        str(tmp_path / "front.avi"),
        str(tmp_path / "side.avi"),
    ]
    assert (clip.name, clip.rig) == ("front", None)


def test_a_view_of_another_host_is_not_touched(folder: Path, decoder: Decoder) -> None:
    (folder / "cam2.avi").write_bytes(b"")
    settings = Settings(clip=str(folder), cameras={"cam2": CameraSettings(device=63)})
    clip = open_clip(settings, decoder, numbers=(1,))
    assert [view.number for view in clip.views] == [1]


def test_an_upright_picture_keeps_its_shape(tmp_path: Path, decoder: Decoder) -> None:
    settings = Settings(
        cameras={"cam1": CameraSettings(source=film(tmp_path / "a.avi", size=(270, 480)))}
    )
    assert open_clip(settings, decoder).views[0].size == (90, 160)


def test_capture_times_place_the_frames_and_the_rate_carries_on_behind_them(
    folder: Path, decoder: Decoder
) -> None:
    tell(folder, fps=15, capture_s={"cam1": [0.0, 0.2, 0.3], "cam2": [0.0, 0.1, 0.3]})
    clip = opened(folder, decoder)
    first = clip.views[0]
    assert [first.captured_s(index) for index in (0, 1, 2)] == [0.0, 0.2, 0.3]
    assert first.captured_s(5) == pytest.approx(0.3 + 3 / 15)
    assert len(clip.warnings) == 2
    assert "3 capture times for camera 1" in clip.warnings[0]


def test_without_capture_times_the_rate_places_the_frames() -> None:
    view = ClipView(1, "cam1.avi", SIZE, SIZE, 25.0, 100)
    assert [view.captured_s(index) for index in (0, 1, 50)] == [0.0, 0.04, 2.0]


def test_clips_of_different_length_and_size_run_on_with_a_word(
    folder: Path, decoder: Decoder
) -> None:
    film(folder / "cam2.avi", frames=9, size=(640, 480))
    clip = opened(folder, decoder)
    assert [view.size for view in clip.views] == [(160, 120), (160, 120)]
    assert clip.warnings == (
        "the views differ in size: 320x240 and 640x480",
        "the views differ in length: 12 and 9 frames",
    )
    assert clip.rig is not None
    assert clip.rig.cameras[1].K[0][0] == pytest.approx(420 / 2)


@pytest.mark.parametrize(("apart_deg", "odd"), [(0, 1), (20, 1), (40, 0), (90, 0), (180, 1)])
def test_cameras_that_see_nearly_one_outline_are_named(
    folder: Path, decoder: Decoder, apart_deg: int, odd: int
) -> None:
    """Camera 2 turned about the vertical from where it looks as camera 1 does."""
    path = folder / "calibration.json"
    calibrate(path)
    told = json.loads(path.read_text())
    sine, cosine = math.sin(math.radians(apart_deg)), math.cos(math.radians(apart_deg))
    told["cameras"][1]["R"] = [[cosine, 0, sine], [0, -1, 0], [sine, 0, -cosine]]
    path.write_text(json.dumps(told))
    warnings = opened(folder, decoder).warnings
    assert [f"look {apart_deg} degrees apart" in one for one in warnings] == [True] * odd


def test_views_of_other_rates_are_looked_at_at_the_slower_ones(
    folder: Path, decoder: Decoder
) -> None:
    film(folder / "cam2.avi", fps=30.0)
    clip = opened(folder, decoder)
    assert [view.fps for view in clip.views] == [15.0, 15.0]
    assert [view.picked for view in clip.views] == [(), tuple(range(0, 12, 2))]
    assert any("cam2.avi those 6 are looked at" in warning for warning in clip.warnings)


def test_each_camera_has_a_rate_of_its_own_where_that_is_told(
    folder: Path, decoder: Decoder
) -> None:
    """Both files say 15: of the faster one every second frame is looked at."""
    tell(folder, fps={"cam1": 12.5, "cam2": 25})
    clip = opened(folder, decoder)
    assert [view.fps for view in clip.views] == [12.5, 12.5]
    assert [view.picked for view in clip.views] == [(), tuple(range(0, 12, 2))]
    assert clip.views[1].captured_s(2) == pytest.approx(0.08)
    tell(folder, fps={"cam2": 30})
    assert [view.fps for view in opened(folder, decoder).views] == [15.0, 15.0]


def test_a_view_whose_capture_times_are_told_keeps_its_frames(
    folder: Path, decoder: Decoder
) -> None:
    film(folder / "cam2.avi", fps=25.0)
    times = [n / 15 for n in range(12)]
    tell(folder, fps=15, capture_s={"cam1": times, "cam2": times})
    assert [view.picked for view in opened(folder, decoder).views] == [(), ()]


def test_the_offset_of_the_settings_sets_camera_2_back(folder: Path, decoder: Decoder) -> None:
    first, second = open_clip(Settings(clip=str(folder), offset_s=0.5), decoder).views
    assert first.captured_s(3) == pytest.approx(3 / 15)
    assert second.captured_s(3) == pytest.approx(3 / 15 - 0.5)
    own = {"cam1": CameraSettings(offset_s=0.25), "cam2": CameraSettings(offset_s=-0.25)}
    each = open_clip(Settings(clip=str(folder), offset_s=0.5, cameras=own), decoder).views
    assert [view.late_s for view in each] == [0.25, -0.25], "each camera's own goes before"


@pytest.mark.parametrize(("hz", "frames"), [(10.0, 5), (15.0, 8), (25.0, 13), (30.0, 15)])
def test_half_a_second_has_as_many_frames_as_the_rate_says(hz: float, frames: int) -> None:
    view = ClipView(1, "cam1.avi", (160, 120), (160, 120), hz, 100)
    assert view.frames_in(SilhouetteSettings().empty_s) == frames
    assert view.frames_in(SilhouetteSettings(empty_frames=6).empty_s) == round(6 / 15 * hz)
    uneven = msgspec.structs.replace(view, capture_s=(0.0, 0.2, 0.4, 0.6))
    assert uneven.frames_in(0.5) == 3


def test_a_missing_folder_file_or_source_is_named(tmp_path: Path, decoder: Decoder) -> None:
    gone = str(tmp_path / "gone")
    assert f"no clip folder {gone}" in refusal(Settings(clip=gone), decoder)
    assert "set clip" in refusal(Settings(), decoder)
    assert "neither cam1.* nor cam2.*" in refusal(Settings(clip=str(tmp_path)), decoder)
    view = CameraSettings(source=gone + ".avi")
    assert "gone.avi: check the path" in refusal(Settings(cameras={"cam1": view}), decoder)
    file = film(tmp_path / "walk.avi")
    assert "walk.avi is a file" in refusal(Settings(clip=file), decoder)
    plate = CameraSettings(source=file, background=str(tmp_path / "plate.png"))
    assert "plate.png: check the path" in refusal(Settings(cameras={"cam1": plate}), decoder)


def test_a_picture_is_no_film(tmp_path: Path, decoder: Decoder) -> None:
    cv2.imwrite(str(tmp_path / "room.png"), np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
    camera = CameraSettings(source=str(tmp_path / "room.png"))
    assert "room.png is one picture, no video: name a video" in refusal(
        Settings(cameras={"cam1": camera}), decoder
    )


@pytest.mark.parametrize("name", ["notes.txt", "notes.nfo", "walk.asc"])
def test_a_text_is_no_video(tmp_path: Path, decoder: Decoder, name: str) -> None:
    """FFmpeg draws it, letter by letter, as a video of a terminal."""
    (tmp_path / name).write_text("a walk, on Monday\n" * 300)
    camera = CameraSettings(source=str(tmp_path / name))
    assert f"{name} is text, no video: name a video" in refusal(
        Settings(cameras={"cam1": camera}), decoder
    )


def test_a_background_of_another_shape_is_refused(tmp_path: Path, decoder: Decoder) -> None:
    source, plate = film(tmp_path / "cam1.avi"), tmp_path / "empty.png"
    camera = CameraSettings(source=source, background=str(plate))
    cv2.imwrite(str(plate), np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
    assert open_clip(Settings(cameras={"cam1": camera}), decoder).views[0].background == str(plate)
    cv2.imwrite(str(plate), np.zeros((180, 320, 3), np.uint8))
    said = refusal(Settings(cameras={"cam1": camera}), decoder)
    assert "empty.png has 320x180 pixels" in said
    assert "cam1.avi 320x240: take an empty frame of the same camera" in said


@pytest.mark.parametrize(
    ("content", "word"), [(b"", "is empty"), (b"text\n" * 50, "no picture")], ids=["empty", "text"]
)
def test_a_file_that_is_no_video_is_named(
    folder: Path, decoder: Decoder, content: bytes, word: str
) -> None:
    (folder / "cam2.avi").write_bytes(content)
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "cam2.avi" in said
    assert word in said


def test_a_video_cut_off_in_its_head_is_refused(folder: Path, decoder: Decoder) -> None:
    video = folder / "cam1.avi"
    video.write_bytes(video.read_bytes()[:150])
    assert "cam1.avi gives no picture" in refusal(Settings(clip=str(folder)), decoder)


def test_a_file_that_may_not_be_read_is_said_to_be_so(
    folder: Path, decoder: Decoder, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = Path.open

    def closed(path: Path, *given: Any, **more: Any) -> Any:
        if path.suffix == ".avi":
            raise PermissionError(13, "Permission denied")
        return opened(path, *given, **more)

    monkeypatch.setattr(Path, "open", closed)
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "cam1.avi: Permission denied; see that you may read it" in said


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("plate.png", "plate.png gives no picture: save the picture anew, as PNG or JPEG"),
        ("plate.avi", "plate.avi gives no picture: convert it"),
        ("", "is a folder: name a file in it"),
    ],
)
def test_a_background_that_is_no_picture_is_named_with_its_own_cure(
    folder: Path, decoder: Decoder, name: str, said: str
) -> None:
    if name:
        (folder / name).write_bytes(b"no picture")
    camera = CameraSettings(source=str(folder / "cam1.avi"), background=str(folder / name))
    assert said in refusal(Settings(cameras={"cam1": camera}), decoder)


def test_two_videos_of_one_camera_are_not_guessed_between(folder: Path, decoder: Decoder) -> None:
    film(folder / "cam1.mkv")
    (folder / "cam1.png").write_bytes(b"a still beside the video is none of the two")
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "2 videos of cam1 (cam1.avi, cam1.mkv)" in said


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("{", "cannot read"),
        ('{"fps": "fast"}', "fps must be a number or a table, got text"),
        ('{"fps": {"cam1": 15, "cam2": -3}}', "rate of -3"),
        ('{"fps": 0}', "rate of 0"),
        ('{"capture_s": {"cam1": [0.0, 0.2, 0.1]}}', "capture_s of cam1 does not increase"),
    ],
)
def test_a_bad_meta_file_is_named_with_the_place(
    folder: Path, decoder: Decoder, text: str, word: str
) -> None:
    (folder / "meta.json").write_text(text)
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "meta.json" in said
    assert word in said


def test_a_calibration_for_another_shape_or_too_few_cameras_is_refused(
    folder: Path, decoder: Decoder
) -> None:
    calibrate(folder / "calibration.json", size=(640, 360))
    said = refusal(Settings(clip=str(folder)), decoder)
    assert "640x360" in said
    assert "320x240" in said
    calibrate(folder / "calibration.json", names=("only",))
    assert "has 1 camera, the clip has a view 2" in refusal(Settings(clip=str(folder)), decoder)
    (folder / "calibration.json").write_text("{}")
    assert "is no calibration" in refusal(Settings(clip=str(folder)), decoder)
    named = Settings(clip=str(folder), calibration=str(folder / "gone.json"))
    assert "gone.json" in refusal(named, decoder)


def test_a_video_that_ended_early_is_told() -> None:
    view = ClipView(1, "cam1.avi", SIZE, SIZE, 15.0, 69)
    assert shortfall(view, Ending(69)) == ""
    assert shortfall(view, Ending(40, damaged=1)) == (
        "cam1.avi was cut off or is damaged: 40 of 69 frames could be read; copy or record it again"
    )


class Facts:
    """A decoder that knows what each source is, and keeps which were asked for."""

    def __init__(self, **known: VideoInfo) -> None:
        self.known, self.asked = known, list[Source]()

    def probe(self, source: Source) -> VideoInfo:
        self.asked.append(source)
        return self.known[Path(str(source)).stem]

    def close(self) -> None:
        self.asked.append("closed")

    def __enter__(self) -> "Facts":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def clip_of_facts(folder: Path, facts: Any, **more: Any) -> Clip:
    folder.mkdir(exist_ok=True)
    for number in (1, 2):
        (folder / f"cam{number}.mkv").write_bytes(b"%d" % number)
    return open_clip(Settings(clip=str(folder), **more), facts)


def test_a_decoder_of_its_own_is_closed_and_one_that_was_given_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    info = VideoInfo(320, 240, 15.0, 12)
    own, given = Facts(cam1=info, cam2=info), Facts(cam1=info, cam2=info)
    monkeypatch.setattr("common.video.clips.Decoder", lambda: own)
    clip_of_facts(tmp_path, given)
    assert ([str(one)[-8:] for one in given.asked], own.asked) == (["cam1.mkv", "cam2.mkv"], [])
    clip_of_facts(tmp_path, None)
    assert [str(one)[-8:] for one in own.asked] == ["cam1.mkv", "cam2.mkv", "closed"]


def test_a_file_and_a_camera_are_what_they_say_or_what_is_told_of_them(tmp_path: Path) -> None:
    """Rate: the settings' word, the meta file's, the file's own; a camera's own, or the paper's."""
    facts = Facts(cam1=VideoInfo(640, 480, 20.0, 9), **{"3": VideoInfo(320, 240, 0.0, 7)})
    camera = CameraSettings(device=3)
    tell(tmp_path, fps=25, capture_s={"cam2": [0.0, 0.5]})
    first, second = clip_of_facts(
        tmp_path, facts, cameras={"cam2": camera}, offset_s=0.5, fps=24.0
    ).views
    assert (first.fps, first.frames, first.size, first.late_s) == (24.0, 9, (160, 120), 0.0)
    assert (second.fps, second.frames, second.source_size) == (15.0, 0, (320, 240))
    assert (second.late_s, second.capture_s) == (0.5, ())
    first, _ = clip_of_facts(tmp_path, facts, cameras={"cam2": camera}, size="64x64").views
    assert (first.fps, first.size) == (25.0, (64, 48))
    tell(tmp_path, capture_s={"cam1": [0.0, 0.5]})
    facts.known["3"] = VideoInfo(320, 240, 30.0, 0)
    first, second = clip_of_facts(tmp_path, facts, cameras={"cam2": camera}).views
    assert (first.fps, first.capture_s, second.fps) == (20.0, (0.0, 0.5), 30.0)


def test_times_beside_a_video_stand_for_meta_json_where_a_recording_was_killed(
    tmp_path: Path,
) -> None:
    """From the first frame of all on; the last line was not written to its end."""
    facts = Facts(cam1=VideoInfo(640, 480, 20.0, 0), cam2=VideoInfo(640, 480, 20.0, 0))
    (tmp_path / "cam1.times.txt").write_text("70.5000\n71.0000\n71.5")
    (tmp_path / "cam2.times.txt").write_text("70.7500\n71.2500\n71.7500\n")
    first, second = clip_of_facts(tmp_path, facts).views
    assert (first.capture_s, second.capture_s) == ((0.0, 0.5), (0.25, 0.75, 1.25))
    assert (first.fps, second.fps) == (2.0, 2.0)


@pytest.mark.parametrize("told", [1, 2])
def test_lengths_that_differ_are_no_news_where_one_views_times_are_told(
    tmp_path: Path, told: int
) -> None:
    facts = Facts(cam1=VideoInfo(640, 480, 15.0, 3), cam2=VideoInfo(640, 480, 15.0, 4))
    assert clip_of_facts(tmp_path, facts).warnings == (
        "the views differ in length: 3 and 4 frames",
    )
    tell(tmp_path, capture_s={f"cam{told}": [n / 15 for n in range(2 + told)]})
    assert clip_of_facts(tmp_path, facts).warnings == ()


def test_a_video_without_a_rate_is_refused_unless_it_is_told(tmp_path: Path) -> None:
    facts: Any = Facts(cam1=VideoInfo(640, 480, 0.0, 9), cam2=VideoInfo(640, 480, 15.0, 9))
    with pytest.raises(ClipError, match=r"cam1\.mkv has no frame rate: set fps in a meta\.json"):
        clip_of_facts(tmp_path, facts)
    assert [view.fps for view in clip_of_facts(tmp_path, facts, fps=12.0).views] == [12.0, 12.0]


@pytest.mark.parametrize(
    ("width", "refused"), [(325, False), (327, True), (315, False), (313, True)]
)
def test_a_background_may_differ_by_two_hundredths_in_its_shape(
    tmp_path: Path, width: int, refused: bool
) -> None:
    """Half as large as the video: 4 to 3 within 2 %."""
    facts: Any = Facts(
        cam1=VideoInfo(640, 480, 15.0, 9),
        cam2=VideoInfo(640, 480, 15.0, 9),
        plate=VideoInfo(width, 240, 0.0, 1),
    )
    (tmp_path / "plate.png").write_bytes(b"p")
    camera = CameraSettings(background=str(tmp_path / "plate.png"))
    if refused:
        said = rf"plate\.png has {width}x240 pixels, .*cam1\.mkv 640x480: take an empty frame"
        with pytest.raises(ClipError, match=said):
            clip_of_facts(tmp_path, facts, cameras={"cam1": camera})
    else:
        assert clip_of_facts(tmp_path, facts, cameras={"cam1": camera}).views[0].background


def test_an_avi_that_does_not_begin_as_one_is_refused_though_pictures_are_found_in_it(
    tmp_path: Path,
) -> None:
    facts: Any = Facts(a=VideoInfo(64, 48, 15.0, 9), **{"7": VideoInfo(64, 48, 0.0, 0)})
    for name, content in (("a.avi", b"RIFF1234"), ("a.mkv", b"any"), ("a.AVI", b"RIFF")):
        (tmp_path / name).write_bytes(content)
        assert probed(str(tmp_path / name), facts).frames == 9
    (tmp_path / "a.avi").write_bytes(b"movi1234")
    with pytest.raises(ClipError, match=r"a\.avi is no AVI from its first byte on: copy or record"):
        probed(str(tmp_path / "a.avi"), facts)
    assert probed(7, facts).width == 64


def test_what_a_decoder_says_of_a_source_is_the_refusal(tmp_path: Path) -> None:
    class Refusing(Facts):
        def probe(self, source: Source) -> VideoInfo:
            raise Undecodable(f"{source} gives no picture")

    refusing: Any = Refusing()
    with pytest.raises(ClipError, match=r"^5 gives no picture$"):
        probed(5, refusing)


def test_the_calibration_is_the_one_named_else_the_clips_else_the_one_above_it(
    tmp_path: Path,
) -> None:
    clip = tmp_path / "walk"
    clip.mkdir()
    assert find_calibration(Settings(), clip) is None
    above, own = tmp_path / "calibration.json", clip / "calibration.json"
    above.touch()
    assert find_calibration(Settings(), clip) == above
    own.touch()
    assert find_calibration(Settings(), clip) == own
    assert find_calibration(Settings(calibration="c.json"), clip) == Path("c.json")


def test_what_stands_beside_a_clip_is_told_without_its_videos(tmp_path: Path) -> None:
    for number in (1, 2):
        (tmp_path / f"cam{number}.avi").touch()
    assert meta_of(Settings(clip=str(tmp_path))) == Meta()
    tell(tmp_path, performer="r07", acts=[{"name": "squat", "first": 3, "last": 9}])
    told = meta_of(Settings(clip=str(tmp_path)))
    assert (told.performer, told.acts) == ("r07", (Act("squat", 3, 9),))


def test_a_clip_is_named_after_its_folder_or_its_first_video(
    folder: Path, decoder: Decoder
) -> None:
    camera = CameraSettings(source=str(folder / "cam2.avi"))
    assert open_clip(Settings(cameras={"cam2": camera}), decoder).name == "cam2"
    assert open_clip(Settings(clip=str(folder), every=2), decoder).every == 2


def test_the_only_camera_of_a_calibration_is_the_only_views(folder: Path, decoder: Decoder) -> None:
    calibrate(folder / "calibration.json", names=("only",))
    (folder / "cam1.avi").unlink()
    rig = open_clip(Settings(clip=str(folder)), decoder, (2,)).rig
    assert rig is not None
    assert [camera.name for camera in rig.cameras] == ["only"]


def test_the_development_clips_open_with_truth_and_gaps(data_dir: Path, decoder: Decoder) -> None:
    """The truth's clock and the capture times agree, also where frames are missing."""
    for folder in (
        data_dir / "dev" / "r01_t1_01_walk_in_place",
        data_dir / "dev_stress" / "frame_drops",
    ):
        clip = opened(folder, decoder)
        truth = np.load(folder / "truth.npz")
        assert clip.warnings == ()
        assert clip.rig is not None
        for view in clip.views:
            of_frame = truth[f"frames_cam{view.number}"]
            assert view.frames == len(of_frame)
            times_s = [view.captured_s(index) for index in range(view.frames)]
            assert times_s == pytest.approx(truth["time"][of_frame], abs=1e-3)
            joints_px = project(clip.rig.cameras[view.number - 1], truth["joints3d"][30, :, :])
            seen_px = truth[f"joints2d_cam{view.number}"][30] / 2
            assert joints_px == pytest.approx(seen_px, abs=0.3)
