"""The empty room: from a plate, from the opening, from the clip, from a camera."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from spoiling import Film, copied, film_of, refilmed, write_video

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.config.part_settings import CameraSettings, SilhouetteSettings
from common.config.settings import Settings
from common.video.clip_facts import ClipView
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import ALL, Decoded, Wanted
from viewer.background.background import Background, learn
from viewer.room import background_source
from viewer.room.background_source import (
    LOOKED_AT,
    Opening,
    _looked_at,
    _stride,
    background_of_film,
    keep,
    of_clip,
    opening_of_run,
    opening_of_view,
)
from viewer.room.room_people import Look

GREY_LEVELS = 5
"""T7's bound of what a learnt background may be off."""


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    with Decoder() as one:
        yield one


def view_of(folder: Path, decoder: Decoder, camera: CameraSettings | None = None) -> ClipView:
    settings = Settings(clip=str(folder), cameras={"cam1": camera or CameraSettings()})
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


@pytest.mark.slow
def test_somebody_in_the_opening_frames_is_noticed(
    clip: Path, decoder: Decoder, tmp_path: Path
) -> None:
    """Missing empty frames: the background comes from the clip, which is said, with a cure."""
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[40:60] + 6 * film[:8], cameras=(1,))
    _, odd, _ = opening_of_view(view_of(folder, decoder), SilhouetteSettings(), decoder)
    assert "cam1.avi does not open with an empty room" in odd
    assert "cameras.cam1.background" in odd
    view = view_of(folder, decoder)
    of_a_film = background_of_film(view, SilhouetteSettings(), decoder).odd
    assert of_a_film == odd.replace("cameras.cam1.background", "--background")


@pytest.mark.slow
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
    write_video(tmp_path / "plate.avi", 8 * [larger])
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
    view = ClipView(1, 0, (160, 120), (160, 120), 15.0, 0)
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
    began = ClipView(1, 0, (320, 240), (160, 120), 15.0, 0)
    again = msgspec.structs.replace(began, source_size=(320, 180), size=(160, 90))
    opening_of_run(began, SilhouetteSettings(), FakeCamera(blank(160, 120)), tmp_path)
    with pytest.raises(ClipError, match=r"camera 0 gives.*160x90.*160x120 then\): start the run"):
        opening_of_run(again, SilhouetteSettings(), FakeCamera(blank(160, 90)), tmp_path)


def blank(width: int, height: int) -> Film:
    return [np.full((height, width, 3), 90, np.uint8)]


FILM_VIEW = ClipView(1, "film.avi", (8, 6), (8, 6), 10.0, 400)


def numbered(n: int) -> np.ndarray:
    return np.full((6, 8, 3), n, np.uint8)


class Numbers:
    """A reader of pictures that show their own number."""

    def __init__(self, count: int) -> None:
        self.count, self.asked = count, []  # type: ignore[var-annotated]

    def frames(self, source: object, size: object, wanted: Wanted) -> Iterator[Decoded]:
        self.asked.append((source, size, wanted.quarters))
        return (Decoded(n, 0.0, numbered(n % 250)) for n in range(self.count))


def test_the_opening_and_frames_from_all_over_are_looked_at() -> None:
    """Half a second of ten frames, then every tenth of 400, for forty; of a long film 1500."""
    reader: Any = Numbers(400)
    opening, sample = _looked_at(FILM_VIEW, SilhouetteSettings(), reader)
    assert [int(picture[0, 0, 0]) for picture in opening] == [0, 1, 2, 3, 4]
    assert [int(p[0, 0, 0]) for p in sample] == [n % 250 for n in range(0, 400, 10)]
    assert reader.asked == [("film.avi", (8, 6), 0)]
    long = msgspec.structs.replace(FILM_VIEW, frames=5000)
    assert _stride(long) == 38
    assert _stride(msgspec.structs.replace(FILM_VIEW, frames=41)) == 2
    assert _stride(msgspec.structs.replace(FILM_VIEW, frames=0)) == 1
    sample = _looked_at(long, SilhouetteSettings(), Numbers(5000))[1]  # type: ignore[arg-type]
    assert len(list(sample)) == -(-LOOKED_AT // 38)


SOMEBODY = Landmarks(tuple((float(n), 1.0) for n in range(15)), (0.9,) * 15)


class Clip:
    """A clip of which each stage is decided here; what is made, and in which order it is tried."""

    def __init__(
        self,
        patch: pytest.MonkeyPatch,
        still: bool = True,
        empty: bool = False,
        seen: tuple[bool, ...] = (True, True),
        first: bool = True,
        sure: bool = True,
    ) -> None:
        self.rooms = {
            name: learn([numbered(level)])
            for name, level in (("uncovered", 11), ("behind", 12), ("around", 13), ("opened", 14))
        }
        self.told: dict[str, Any] = {}
        self.takes = "uncovered"
        rooms, told = self.rooms, self.told

        def made(name: str) -> Any:
            def make(*given: Any) -> Background:
                told[name] = given
                return rooms[name]

            return make

        def looked_at(pictures: Any) -> list[Look]:
            if len(pictures) == 1:
                told["opening"] = int(pictures[0][0, 0, 0])
                return [Look(SOMEBODY, first)]
            told["judges"] = [int(picture[0, 0, 0]) for picture in pictures]
            return [Look(SOMEBODY, seen[n % len(seen)]) for n in range(len(pictures))]

        def best_of(groups: Any, *rest: Any) -> Background:
            tried = [[make() for make in group] for group in groups]
            names = {id(room): name for name, room in rooms.items()}
            told["groups"] = [[names[id(room)] for room in group] for group in tried]
            told["best_of"] = rest
            return rooms[self.takes]

        for name, value in {
            "is_still": lambda _: still,
            "is_empty_opening": lambda *_: empty,
            "looked_at": looked_at,
            "are_sure": lambda _: sure,
            "standing": lambda *given: given,
            "learn_uncovered": made("uncovered"),
            "learn_behind": made("behind"),
            "learn_around": made("around"),
            "learnt": made("opened"),
            "best_of": best_of,
        }.items():
            patch.setattr(background_source, name, value)

    def opening(self) -> Opening:
        """Of five pictures at first, and 45 all over."""
        return of_clip(
            [numbered(100 + n) for n in range(5)],
            [numbered(90 + n) for n in range(45)],
            SilhouetteSettings(),
            FILM_VIEW,
        )


def test_an_empty_opening_is_the_room_and_nobody_is_looked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clip = Clip(monkeypatch, empty=True)
    assert clip.opening() == (clip.rooms["opened"], "", None)
    assert set(clip.told) == {"opened"}


@pytest.mark.parametrize(
    ("decided", "groups"),
    [
        ({}, [["uncovered", "behind"], ["around"], ["opened"]]),
        ({"first": False}, [["opened"], ["uncovered", "behind"], ["around"]]),
        ({"sure": False}, [["uncovered"], ["around"], ["opened"]]),
        ({"still": False, "empty": True}, [["uncovered", "behind"], ["around"]]),
        ({"seen": (False, False)}, [["uncovered"]]),
        ({"seen": (False, True)}, [["uncovered", "behind"], ["around"], ["opened"]]),
    ],
    ids=["somebody", "nobody at first", "not sure", "moving", "nobody at all", "later"],
)
def test_backgrounds_are_tried_the_likelier_first(
    monkeypatch: pytest.MonkeyPatch, decided: dict[str, Any], groups: list[list[str]]
) -> None:
    clip = Clip(monkeypatch, **decided)
    found = clip.opening()
    assert clip.told["groups"] == groups
    assert clip.told["opening"] == 100
    assert clip.told["judges"] == list(range(90, 135, 3))  # twenty of 45 at most
    odd = (
        "film.avi does not open with an empty room: the background is estimated from the clip "
        "(name an empty picture with cameras.cam1.background)"
    )
    knows = decided.get("sure", True) and decided.get("seen", (True,))[0]
    assert found == (clip.rooms["uncovered"], odd, SOMEBODY if knows else None)
    judges, looks, settings = clip.told["best_of"]
    assert (len(judges), len(looks), settings) == (15, 15, SilhouetteSettings())


def test_backgrounds_are_made_of_the_frames_that_tell_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is uncovered of all, what is behind or around somebody of those that are judged."""
    clip = Clip(monkeypatch)
    clip.opening()
    assert len(clip.told["uncovered"][0]) == 45
    judges, body, regions = clip.told["behind"]
    assert (len(judges), len(regions), len(body[1])) == (15, 15, 15)
    assert clip.told["around"][0] is judges
    assert clip.told["around"][1] is regions
    assert regions[0].shape == (6, 8)


def test_an_opening_that_is_judged_to_be_the_room_is_nothing_odd(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clip = Clip(monkeypatch)
    clip.takes = "opened"
    assert clip.opening() == (clip.rooms["opened"], "", None)


@pytest.mark.parametrize(
    ("odd", "plate", "hidden", "taken"),
    [
        ("", "", 0.0, "busy"),
        ("", "", 0.5, "opening"),
        ("it is busy", "", 0.0, "opening"),
        ("", "room.png", 0.0, "opening"),
    ],
)
def test_a_film_has_the_background_of_all_over_it_where_nobody_stays_on_a_spot(
    monkeypatch: pytest.MonkeyPatch, odd: str, plate: str, hidden: float, taken: str
) -> None:
    """And patches of the frames that are looked at, ten apart."""
    rooms = {"opening": learn([numbered(10)]), "busy": learn([numbered(20)])}
    rooms["busy"].uncertain[: round(6 * hidden)] = True
    monkeypatch.setattr(
        background_source, "opening_of_view", lambda *_: Opening(rooms["opening"], odd, None)
    )
    monkeypatch.setattr(background_source, "learn_uncovered", lambda _: rooms["busy"])
    told: list[Any] = []
    patches: Any = ["a patch"]

    def patches_of(*given: Any) -> Any:
        told.append(given)
        return patches

    monkeypatch.setattr(background_source, "patches_of", patches_of)
    view = msgspec.structs.replace(FILM_VIEW, background=plate)
    found = background_of_film(view, SilhouetteSettings(), Numbers(400))  # type: ignore[arg-type]
    assert found.background is rooms[taken]
    assert found.patches is patches
    assert ("--background" in found.odd) == bool(odd)
    background, sample, spacing, fps = told[0]
    assert background is rooms[taken]
    assert (len(sample), spacing, fps) == (40, 10, 10.0)


def test_a_cameras_film_has_no_patches(monkeypatch: pytest.MonkeyPatch) -> None:
    room = learn([numbered(10)])
    monkeypatch.setattr(background_source, "opening_of_view", lambda *_: Opening(room, "", None))
    view = msgspec.structs.replace(FILM_VIEW, source=0)
    reader: Any = None
    found = background_of_film(view, SilhouetteSettings(), reader)
    assert found == (room, [], "")


def test_only_a_cameras_own_background_is_kept_and_read_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Not a video's, nor a plate's, nor where there is no folder."""
    room = learn([numbered(10)])
    monkeypatch.setattr(background_source, "opening_of_view", lambda *_: Opening(room, "", None))
    camera = msgspec.structs.replace(FILM_VIEW, source=0)
    reader: Any = None
    for view, folder in (
        (FILM_VIEW, tmp_path),
        (camera, None),
        (msgspec.structs.replace(camera, background="room.png"), tmp_path),
    ):
        assert opening_of_run(view, SilhouetteSettings(), reader, folder).background is room
        assert list(tmp_path.iterdir()) == []
    opening_of_run(camera, SilhouetteSettings(), reader, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["background_1.npz"]
    again = opening_of_run(camera, SilhouetteSettings(), reader, tmp_path)
    assert again.background is not room
    assert all(np.array_equal(a, b) for a, b in zip(again.background, room, strict=True))
    wide = msgspec.structs.replace(camera, size=(6, 8))
    with pytest.raises(
        ClipError, match=r"another shape than the run began with \(6x8 at .*, 8x6 then\)"
    ):
        opening_of_run(wide, SilhouetteSettings(), reader, tmp_path)


def test_without_a_background_no_frame_but_the_first_is_read(
    clip: Path, decoder: Decoder, tmp_path: Path
) -> None:
    """A person may stand there, and a folder of learnt backgrounds is not asked."""
    view, without = view_of(clip, decoder), SilhouetteSettings(background="none")
    first = film_of(clip / "cam1.avi")[0]
    for opening in (
        opening_of_view(view, without, decoder),
        opening_of_run(view, without, decoder, tmp_path),
    ):
        assert opening.background.uncertain.all()
        assert (opening.background.centre == first).all()
        assert (opening.odd, opening.somebody) == ("", None)
    of_a_video = background_of_film(view, without, decoder)
    assert of_a_video.background.uncertain.all()
    assert (of_a_video.patches, of_a_video.odd) == ([], "")
