"""One rig by all the clips of it: what of each clip reaches the calibration."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import pytest

from calibration.person.rig_quality import PersonCalibration, Quality
from calibration.tracks.lateness import Clock
from common.config.settings import Settings
from common.rig.camera import paper_rig
from common.rig.rig_file import CalibrationError
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.offline import rig_from_person, rig_of_clips
from runtime.offline.rig_from_person import ON_TIME
from runtime.offline.rig_of_clips import Given, calibrated_by_clips

RIG = paper_rig((160, 120), (200.0, 210.0), (4.0, 4.0))
QUALITY = Quality((), 1.75, 40, 12.0, 1.0, (0.5,), (0.1,))
FIRST = ClipView(1, "a.avi", (320, 240), (160, 120), 15.0, 60)
SECOND = ClipView(2, "b.avi", (320, 240), (160, 120), 15.0, 60)
TWO = Clip("two", (FIRST, SECOND), 1, None, Meta())


class Clips:
    """Clips without pictures, by their paths; each path is its own sighting."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *clips: Clip, offset: str = "") -> None:
        self.clips = {f"c{n}": clip for n, clip in enumerate(clips)}
        self.offset = offset
        self.asked: list[tuple[Any, ...]] = []
        self.read: list[dict[int, int]] = []
        self.decoders: list[int] = []
        self.open_sources = 0
        for name in ("open_clip", "outside_sources", "sightings_of"):
            monkeypatch.setattr(rig_of_clips, name, getattr(self, name))
        monkeypatch.setattr("runtime.offline.rig_of_clips.config_file.load", self.load)
        monkeypatch.setattr(rig_of_clips, "calibrated_by_all", self.calibrated)
        monkeypatch.setattr(rig_from_person, "clocks_of", self.clocks_of)
        monkeypatch.setattr(rig_of_clips, "Decoder", self.decoder)

    @contextmanager
    def decoder(self) -> Iterator[Any]:
        self.decoders.append(1)
        yield object()
        self.decoders.append(-1)

    @property
    def paths(self) -> list[Path]:
        return [Path(name) for name in self.clips]

    def load(self, path: Path) -> Settings:
        return Settings(clip=str(path), offset_s=0.5 if str(path) == self.offset else None)

    def open_clip(self, settings: Settings) -> Clip:
        return self.clips[settings.clip]

    @contextmanager
    def outside_sources(self, settings: Settings, views: tuple[ClipView, ...]) -> Iterator[Any]:
        assert views == self.clips[settings.clip].views
        self.open_sources += 1
        yield {"of": settings.clip}
        self.open_sources -= 1

    def sightings_of(
        self, clip: Clip, settings: Settings, _: object, readers: dict[int, Any], sources: Any
    ) -> str:
        assert clip == self.clips[settings.clip]
        assert sources == {"of": settings.clip}
        assert self.open_sources == 1
        self.read.append(
            {number: id(frame_cache._decoder) for number, frame_cache in readers.items()}
        )
        return settings.clip

    def clocks_of(self, seen: str) -> tuple[Clock, ...]:
        return (Clock(float(seen[1:])),) * (len(self.clips[seen].views) - 1)

    def calibrated(self, *given: Any) -> PersonCalibration:
        self.asked.append(given)
        return PersonCalibration(RIG, (0.3,), (Clock(0.3),), QUALITY)


def test_every_clip_is_seen_by_its_own_films_and_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second's settings say how late it is: it is on time by that. The rig is the films'."""
    clips = Clips(monkeypatch, TWO, TWO, TWO, offset="c1")
    found = calibrated_by_clips(clips.paths, Given(1.9, 55.0))
    clocks = ((Clock(0.0),), (ON_TIME,), (Clock(2.0),))
    assert clips.asked == [(("c0", "c1", "c2"), 1.9, 55.0, clocks)]
    assert (found.quality, found.clocks) == (QUALITY, (Clock(0.3),))
    assert (found.rig.width, found.rig.height) == (320, 240)
    assert [camera.K[0][0] for camera in found.rig.cameras] == [400.0, 420.0]
    assert clips.open_sources == 0
    assert clips.decoders == [1, 1, -1, -1], "one a view, and all are closed"
    assert len({tuple(one.items()) for one in clips.read}) == 1, "the decoders are kept"
    assert clips.read[0].keys() == {1, 2}
    assert len(set(clips.read[0].values())) == 2, "a decoder each"


def test_what_is_not_known_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    clips = Clips(monkeypatch, TWO)
    calibrated_by_clips(clips.paths, Given())
    assert clips.asked == [(("c0",), 1.75, None, ((Clock(0.0),),))]


@pytest.mark.parametrize(
    "views", [(FIRST,), (FIRST, msgspec.structs.replace(SECOND, frames=0))], ids=["one", "camera"]
)
def test_a_clip_without_two_films_is_refused(
    monkeypatch: pytest.MonkeyPatch, views: tuple[ClipView, ...]
) -> None:
    clips = Clips(monkeypatch, TWO, msgspec.structs.replace(TWO, views=views))
    with pytest.raises(
        CalibrationError, match=r"^c1 has not two recorded views: name clips of several cameras$"
    ):
        calibrated_by_clips(clips.paths, Given())
    assert clips.asked == []


def test_clips_of_other_cameras_are_refused_by_their_names(monkeypatch: pytest.MonkeyPatch) -> None:
    third = ClipView(3, "c.avi", (320, 240), (160, 120), 15.0, 60, name="door")
    three = msgspec.structs.replace(TWO, views=(FIRST, SECOND, third))
    clips = Clips(monkeypatch, three, TWO)
    said = "^c1 has the cameras cam1, cam2, the first clip cam1, cam2, door: name clips of one rig$"
    with pytest.raises(CalibrationError, match=said):
        calibrated_by_clips(clips.paths, Given())


def test_cameras_of_nearly_one_size_are_of_one_rig(monkeypatch: pytest.MonkeyPatch) -> None:
    """The calibration is for the first camera's pictures."""
    wide = msgspec.structs.replace(SECOND, source_size=(322, 240))
    clips = Clips(monkeypatch, msgspec.structs.replace(TWO, views=(FIRST, wide)))
    found = calibrated_by_clips(clips.paths, Given())
    assert (found.rig.width, found.rig.height) == (320, 240)


def test_clips_of_several_sizes_are_refused_with_their_sizes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    large = tuple(msgspec.structs.replace(v, source_size=(640, 480)) for v in TWO.views)
    clips = Clips(monkeypatch, msgspec.structs.replace(TWO, views=large), TWO)
    with pytest.raises(CalibrationError) as error:
        calibrated_by_clips(clips.paths, Given())
    assert str(error.value) == "pictures of several sizes (320x240, 640x480) are not of one rig"
    assert clips.asked == []
