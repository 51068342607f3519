"""A film of one camera: what both passes are handed, and what the summary says of them."""

import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from staging import RIG, report

from common.bus.messages import Body, View
from common.config.part_settings import SilhouetteSettings
from common.config.settings import Settings
from common.method import METHODS
from common.notes.notes import Note, Notes
from common.rig.camera import PAPER_ROTATIONS
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.pictures import Ending
from runtime.offline import video_tracking
from runtime.offline.video_passes import (
    CUTTING,
    POSING,
    REPORTS,
    Cutting,
    FirstPass,
    Lifted,
    Posing,
    VideoFacts,
)
from runtime.offline.video_tracking import (
    Followed,
    Heard,
    VideoInput,
    doubtful,
    follow_clip,
    follow_masks,
    unseen,
)
from runtime.store.runs import NO_PERSON_SEEN
from runtime.unfinished.work import Course
from viewer.room.background_source import VideoBackground

VIEW = ClipView(2, "a.mp4", (640, 480), (160, 120), 30.0, 60)
CLIP = Clip("film", (VIEW,), 3, None, Meta("anna", "squat"), ("it is short",))
UNCERTAIN = np.array([[True, False, False], [False, False, False]])
ROOM: Any = SimpleNamespace(uncertain=UNCERTAIN)
BACKGROUND = VideoBackground(ROOM, [], "nothing moves")
NOTES = Notes(note=(Note(4, orientation="left"),))
METHOD = METHODS["default"]
REPORT = report(2)


def body(*score: float, seen: bool = True) -> Body:
    first, second = score or (0.0, 0.0)
    return Body(
        frame=0,
        captured_s=0.0,
        clock_s=0.0,
        status="tracking",
        views="2",
        joints_m=((0.0, 0.0, 0.0),) if seen else (),
        score=(first, second),
    )


class Work:
    """What a run left, by its stage."""

    due = False

    def __init__(self, **left: Any) -> None:
        self.left = left

    def messages(self, name: str) -> list[Any]:
        return [REPORT] * 7 if name == REPORTS else []

    def resumed(self, stage: str, kind: type[Any]) -> Any:
        found = self.left.get(stage)
        return found if isinstance(found, kind) else None

    def save(self, *_: object) -> None:
        raise AssertionError("never due")

    restart = save


class Passes:
    """Both passes without pictures; the first takes 2 s by a clock that ticks seconds."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.bodies = [body(0.1, 0.7), body(0.1, 0.8)]
        self.camera: Any = RIG.cameras[1]
        self.sources: Any = {2: SimpleNamespace(odd=["a landmark is odd"])}
        ticks = itertools.count(10.0)
        monkeypatch.setattr("runtime.offline.video_tracking.time.perf_counter", lambda: next(ticks))
        for name in ("silhouettes_of", "bodies_of", "outside_sources"):
            monkeypatch.setattr(video_tracking, name, getattr(self, name))

    def silhouettes_of(self, *given: Any) -> list[View]:
        self.asked.append(given)
        return [REPORT] * 3

    def bodies_of(self, reports: Any, film: VideoFacts, course: Course, *first: Any) -> Lifted:
        self.asked.append((len(reports), film, course, *first))
        return Lifted(self.bodies, self.camera)

    @contextmanager
    def outside_sources(self, _: Settings, views: tuple[ClipView, ...]) -> Iterator[Any]:
        assert views == (VIEW,)
        yield self.sources


READER: Any = SimpleNamespace(ending=Ending(40, 2))
KNOWN = VideoFacts(Settings(), METHOD, 2, 0.1, None, NOTES, 0.25)


def test_a_film_is_gone_through_twice_and_the_summary_tells_of_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every third of 30 frames a second; a picture of 640 is worked on at 160."""
    passes, work = Passes(monkeypatch), Work()
    heard = Heard(lambda _: 1, lambda _: 2, work)
    done = follow_clip(VideoInput(CLIP, BACKGROUND, NOTES), Settings(), METHOD, READER, heard)
    first_pass, second_pass = passes.asked
    outside = passes.sources[2]
    course = Course(heard.silhouettes, work)
    assert first_pass == (CLIP, BACKGROUND, KNOWN, READER, outside, course)
    cut_off = "a.mp4 was cut off or is damaged: 40 of 60 frames could be read; copy or record it"
    odd = (f"{cut_off} again", "a landmark is odd")
    assert second_pass == (3, KNOWN, Course(heard.poses, work), FirstPass(odd, 1.0, Ending(40, 2)))
    assert done.facts == {
        "clip": "film",
        "cameras": ["cam1", "cam2"],
        "performer": "anna",
        "posture_meant": "squat",
        "seconds": {"silhouettes": 1.0, "poses": 1.0, "all": 2.0},
        "frames_a_second": 1.0,
        "scale_source": "assumed",
        "camera": msgspec.to_builtins(RIG.cameras[1]),
        "unread": {"a.mp4": {"read": 40, "of": 60}},
        "never_uncovered": 0.1667,
        "warnings": ["it is short", "nothing moves", *odd],
    }
    assert (done.bodies, done.reports) == (passes.bodies, [REPORT] * 3)
    assert (done.period_s, done.camera) == (0.1, RIG.cameras[1])
    assert (done.clip, done.background) == (CLIP, ROOM)
    assert done.size == (REPORT.width, REPORT.height) == (160, 120)


def test_a_calibrated_film_keeps_its_camera(monkeypatch: pytest.MonkeyPatch) -> None:
    passes, rig = Passes(monkeypatch), msgspec.structs.replace(RIG, cameras=RIG.cameras[:1])
    clip = msgspec.structs.replace(CLIP, rig=rig)
    done = follow_clip(VideoInput(clip, BACKGROUND), Settings(), METHOD, READER)
    assert passes.asked[1][1] == KNOWN._replace(camera=RIG.cameras[0], notes=Notes())
    assert done.facts["scale_source"] == "calibrated"
    assert "camera" not in done.facts


def test_a_film_that_was_left_goes_on_and_counts_the_time_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Left in the second pass: the first is not done again. Left in the first: it goes on."""
    passes, first = Passes(monkeypatch), FirstPass(("it was dark",), 5.0, Ending(60))
    left: Any = Posing(None, None, first, spent_s=20.0)  # type: ignore[arg-type]
    work = Work(**{POSING: left})
    film = VideoInput(CLIP, BACKGROUND, NOTES)
    done = follow_clip(film, Settings(), METHOD, READER, Heard(work=work))
    ((reports, _, _, told),) = passes.asked
    assert (reports, told) == (7, first)
    assert done.facts["seconds"] == {"silhouettes": 5.0, "poses": 21.0, "all": 26.0}
    assert "it was dark" in done.facts["warnings"]
    assert "unread" not in done.facts

    passes = Passes(monkeypatch)
    cutting: Any = Cutting(None, 9, 30.0)  # type: ignore[arg-type]
    work = Work(**{CUTTING: cutting})
    done = follow_clip(film, Settings(), METHOD, READER, Heard(work=work))
    assert len(passes.asked) == 2
    assert done.facts["seconds"] == {"silhouettes": 31.0, "poses": 1.0, "all": 32.0}


def mask(height: int) -> np.ndarray:
    """A silhouette of so many rows of 120."""
    drawn = np.zeros((120, 160), np.bool_)
    drawn[10 : 10 + height, 20:50] = True
    return drawn


def test_masks_that_are_lower_than_a_person_show_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    """A quarter of 120 rows are 30. The period is that of the masks, or of 25 a second."""
    passes = Passes(monkeypatch)
    heights, settings = (30, 29, 60, 0), Settings(silhouette=SilhouetteSettings())
    silhouette = msgspec.structs.replace(settings.silhouette, min_height_share=0.25)
    settings = msgspec.structs.replace(settings, silhouette=silhouette, mode="thesis")
    reports = [report(1, mask(rows), captured_s=n / 8) for n, rows in enumerate(heights)]
    done = follow_masks("masks", reports, settings)
    assert [bool(one.people) for one in done.reports] == [True, False, True, False]
    assert done.reports[0] is reports[0]
    film = VideoFacts(settings, METHODS["thesis"], 1, 1 / 8, None)
    assert passes.asked[0][:2] == (4, film)
    assert (done.period_s, done.clip, done.background) == (1 / 8, None, None)
    assert done.facts == {
        "clip": "masks",
        "seconds": {"poses": 1.0, "all": 1.0},
        "frames_a_second": 2.0,
        "scale_source": "assumed",
        "camera": msgspec.to_builtins(RIG.cameras[1]),
        "warnings": [],
    }
    passes.bodies = [body(0.1, 0.2)]
    done = follow_masks("one", reports[:1], settings)
    assert done.period_s == 0.04
    assert len(done.facts["warnings"]) == 1


def test_poses_that_mostly_do_not_fit_are_doubtful() -> None:
    """S of 0.6 fits, by the better view; who is not seen does not count; half is enough."""
    fits, misses, away = body(0.1, 0.6), body(0.59, 0.3), body(0.9, 0.9, seen=False)
    assert doubtful([fits, misses]) == ""
    assert doubtful([fits, misses, away]) == ""
    assert doubtful([fits, misses, misses, away]).startswith("only 33% of the poses fit their silh")
    assert doubtful([away]) == unseen([away]) == NO_PERSON_SEEN
    assert doubtful([]) == NO_PERSON_SEEN
    assert unseen([away, misses]) == ""


def test_a_film_without_a_frame_has_the_papers_first_camera() -> None:
    nothing = Followed([], [], 0.1, None, None, None, {})
    assert nothing.turn.tolist() == [list(row) for row in PAPER_ROTATIONS[0]]
    assert nothing._replace(camera=RIG.cameras[1]).turn.tolist() == [
        list(row) for row in RIG.cameras[1].R
    ]
