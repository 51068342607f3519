"""The empty room: from a plate, from the opening, from the clip, from a camera."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest
from spoiling import Film, copied, film_of, refilmed, write_film

from common.body.body import JOINT_NAMES
from common.config.part_settings import CameraSettings, SilhouetteSettings
from common.config.settings import Settings
from common.video.clip_facts import View
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from common.video.decoding import ALL, Decoded, Decoder
from viewer.background.background import Background
from viewer.room.background_source import (
    background_of_film,
    keep,
    opening_of_run,
    opening_of_view,
)

GREY_LEVELS = 5
"""T7's bound of what a learnt background may be off."""


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    with Decoder() as one:
        yield one


def view_of(folder: Path, decoder: Decoder, camera: CameraSettings | None = None) -> View:
    settings = Settings(clip=str(folder), camera_1=camera)
    return open_clip(settings, decoder, (1,)).views[0]


def room_of(clip: Path) -> np.ndarray:
    """The picture of the empty room, as its film shows it before anybody comes."""
    return np.median(film_of(clip / "cam1.avi")[:8], axis=0)


def share_off(room: Background, true: np.ndarray) -> float:
    """Share of the pixels that are further off in brightness than a learnt background may be."""
    return float((np.abs((room.centre - true).mean(axis=-1)) > GREY_LEVELS).mean())


def test_the_opening_frames_show_the_room(clip: Path, decoder: Decoder) -> None:
    room, odd, _ = opening_of_view(view_of(clip, decoder), SilhouetteSettings(), decoder)
    assert odd == ""
    assert share_off(room, room_of(clip)) < 0.001


def test_somebody_in_the_opening_frames_is_noticed(
    clip: Path, decoder: Decoder, tmp_path: Path
) -> None:
    """Missing empty frames: the background comes from the clip, which is said, with a cure."""
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[40:60] + 6 * film[:8], cameras=(1,))
    _, odd, _ = opening_of_view(view_of(folder, decoder), SilhouetteSettings(), decoder)
    assert "cam1.avi does not open with an empty room" in odd
    assert "camera_1.background" in odd
    view = view_of(folder, decoder)
    of_a_film = background_of_film(view, SilhouetteSettings(), decoder).odd
    assert of_a_film == odd.replace("camera_1.background", "--background")


def test_who_stays_all_through_is_known_from_the_first_frame(
    clip: Path, decoder: Decoder, tmp_path: Path
) -> None:
    """All of a clip tells where they are, which its first frame alone may not."""
    view = view_of(clip, decoder)
    assert opening_of_view(view, SilhouetteSettings(), decoder).somebody is None
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[40:], cameras=(1,))
    opening = opening_of_view(view_of(folder, decoder), SilhouetteSettings(), decoder)
    assert opening.somebody is not None
    with np.load(clip / "truth.npz", allow_pickle=False) as truth:
        mask = np.unpackbits(truth["mask_cam1"][40], axis=1)[:, : view.size[0]] > 0
    rows, columns = np.nonzero(mask)
    pelvis_px = opening.somebody.joints_px[JOINT_NAMES.index("pelvis")]
    assert columns.min() < pelvis_px[0] < columns.max()
    assert rows.min() < pelvis_px[1] < rows.max()


def test_a_plate_goes_before_the_clip(clip: Path, decoder: Decoder, tmp_path: Path) -> None:
    plate = np.full((120, 160, 3), (10, 120, 200), np.uint8)
    cv2.imwrite(str(tmp_path / "plate.png"), plate)
    camera = CameraSettings(background=str(tmp_path / "plate.png"))
    room, odd, _ = opening_of_view(view_of(clip, decoder, camera), SilhouetteSettings(), decoder)
    assert odd == ""
    assert share_off(room, plate) == 0.0


def test_a_plate_may_be_a_film_and_larger(clip: Path, decoder: Decoder, tmp_path: Path) -> None:
    larger = cv2.resize(room_of(clip).astype(np.uint8), (320, 240), interpolation=cv2.INTER_NEAREST)
    write_film(tmp_path / "plate.avi", 8 * [larger])
    camera = CameraSettings(background=str(tmp_path / "plate.avi"))
    room, odd, _ = opening_of_view(view_of(clip, decoder, camera), SilhouetteSettings(), decoder)
    assert odd == ""
    assert share_off(room, room_of(clip)) < 0.01


class FakeCamera(Decoder):
    """Gives a film's frames as a camera that never ends would."""

    def __init__(self, film: Film) -> None:
        super().__init__()
        self.film, self.given = film, 0

    def frames(self, source, size, wanted=ALL):  # type: ignore[no-untyped-def]
        while True:
            yield Decoded(self.given, 0.0, self.film[self.given % len(self.film)])
            self.given += 1


def test_a_cameras_room_is_what_it_shows_first(clip: Path, decoder: Decoder) -> None:
    """No more frames are taken than the settings say; the person comes after them."""
    camera = FakeCamera(film_of(clip / "cam1.avi"))
    view = msgspec.structs.replace(view_of(clip, decoder), source=0, frames=0)
    room, odd, _ = opening_of_view(view, SilhouetteSettings(), camera)
    assert odd == ""
    assert camera.given <= 8
    assert share_off(room, room_of(clip)) < 0.001


def test_a_plate_goes_before_what_a_camera_shows(
    clip: Path, decoder: Decoder, tmp_path: Path
) -> None:
    """And is read anew each time: it is not kept as what was learnt of the camera is."""
    plate = np.full((120, 160, 3), (10, 120, 200), np.uint8)
    cv2.imwrite(str(tmp_path / "plate.png"), plate)
    view = msgspec.structs.replace(
        view_of(clip, decoder), source=0, frames=0, background=str(tmp_path / "plate.png")
    )
    for _ in range(2):
        room, odd, _ = opening_of_run(view, SilhouetteSettings(), decoder, tmp_path)
        assert odd == ""
        assert share_off(room, plate) == 0.0
    assert not [*tmp_path.glob("*.npz")]


def test_a_viewer_that_is_started_again_knows_its_cameras_room(clip: Path, tmp_path: Path) -> None:
    """Somebody stands before the camera by then; a run after that learns its room anew."""
    film = film_of(clip / "cam1.avi")
    view = View(1, 0, (160, 120), (160, 120), 15.0, 0)
    first, again, other = tmp_path / "first", FakeCamera(film[40:48]), tmp_path / "other"
    first.mkdir()
    other.mkdir()
    learnt, _, _ = opening_of_run(view, SilhouetteSettings(), FakeCamera(film), first)
    room, odd, _ = opening_of_run(view, SilhouetteSettings(), again, first)
    assert all(np.array_equal(*pair) for pair in zip(room, learnt, strict=True))
    assert (odd, again.given) == ("", 0)
    room, _, _ = opening_of_run(view, SilhouetteSettings(), again, other)
    assert share_off(room, room_of(clip)) > 0.02
    anew = learnt._replace(centre=learnt.centre + 1.0)
    keep(first, view, anew)
    room, _, _ = opening_of_run(view, SilhouetteSettings(), again, first)
    assert np.array_equal(room.centre, anew.centre), "as it was learnt last"


def test_a_camera_that_comes_back_with_another_picture_is_refused(tmp_path: Path) -> None:
    """Joints would be told by a rig of other pictures, and its room would not fit either."""
    began = View(1, 0, (320, 240), (160, 120), 15.0, 0)
    again = msgspec.structs.replace(began, source_size=(320, 180), size=(160, 90))
    opening_of_run(began, SilhouetteSettings(), FakeCamera(blank(160, 120)), tmp_path)
    with pytest.raises(ClipError, match=r"camera 0 gives.*160x90.*160x120 then\): start the run"):
        opening_of_run(again, SilhouetteSettings(), FakeCamera(blank(160, 90)), tmp_path)


def blank(width: int, height: int) -> Film:
    return [np.full((height, width, 3), 90, np.uint8)]
