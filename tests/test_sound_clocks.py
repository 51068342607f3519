"""The delays of views by ear: who is asked, what is applied, and what stays with the motion."""

import numpy as np
import pytest
from test_sound_offset import heard

from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.clip_sources import offsets_of
from runtime import sound_clocks
from runtime.offline.rig_check import clock_facts, clock_words
from runtime.sound_clocks import by_ear, heard_words

LATE_S = -1.234


def clip(*names: str) -> Clip:
    views = tuple(
        ClipView(n, f"{name}.avi", (160, 120), (160, 120), 15.0, 100, name=name)
        for n, name in enumerate(names, 1)
    )
    return Clip("clip", views, 1, None, Meta())


def claps(late_s: float, seed: int) -> np.ndarray:
    """A dozen claps, heard by one of several microphones."""
    rng = np.random.default_rng(seed)
    times_s = np.sort(np.random.default_rng(1).uniform(0, 10, 12))
    return heard(rng, times_s + late_s, np.ones(12), 10.0, 0.01)


@pytest.fixture
def ears(monkeypatch: pytest.MonkeyPatch) -> dict[str, np.ndarray | None]:
    """What each video sounds like; others have no sound."""
    sounds: dict[str, np.ndarray | None] = {"cam1.avi": claps(0.0, 2), "cam2.avi": claps(LATE_S, 3)}
    monkeypatch.setattr(sound_clocks, "can_hear", lambda: True)
    monkeypatch.setattr(sound_clocks, "sound_of", lambda path: sounds.get(str(path)))
    return sounds


@pytest.mark.usefixtures("ears")
def test_a_view_is_set_back_by_what_its_sound_tells() -> None:
    found = by_ear(clip("cam1", "cam2"), Settings())
    assert found.late_s[2] == pytest.approx(LATE_S, abs=0.01)
    assert found.clip.views[1].late_s == found.late_s[2]
    assert found.clip.views[0].late_s == 0.0
    assert offsets_of(found.settings) == found.late_s
    told = clock_facts(found.clip, (), offsets_of(found.settings), found.late_s)
    assert told == {}, "the facts are of clocks that were looked at"


@pytest.mark.usefixtures("ears")
def test_what_the_user_says_is_not_asked_of_the_sound() -> None:
    said = Settings(offset_s=0.5)
    assert by_ear(clip("cam1", "cam2"), said).late_s == {}
    own = Settings(cameras={"cam2": CameraSettings(offset_s=0.5)})
    assert by_ear(clip("cam1", "cam2"), own).clip.views[1].late_s == 0.0


def test_a_sound_that_repeats_itself_or_is_missing_leaves_it_to_the_motion(
    ears: dict[str, np.ndarray | None],
) -> None:
    rng = np.random.default_rng(3)
    steps_s = np.arange(-5.0, 15.0, 0.5)
    ears["cam1.avi"], ears["cam2.avi"] = (
        heard(rng, steps_s + late_s, np.ones(40), 10.0, 0.01) for late_s in (0.0, 0.7)
    )
    assert by_ear(clip("cam1", "cam2"), Settings()).late_s == {}
    ears["cam2.avi"] = None
    assert by_ear(clip("cam1", "cam2"), Settings()).late_s == {}
    assert by_ear(clip("cam1"), Settings()).late_s == {}


def test_of_three_cameras_the_one_with_a_sound_is_set_back(
    ears: dict[str, np.ndarray | None],
) -> None:
    ears["left.avi"], ears["door.avi"] = ears["cam1.avi"], ears["cam2.avi"]
    found = by_ear(
        clip("left", "hall", "door"),
        Settings(
            cameras={
                name: CameraSettings(source=f"{name}.avi") for name in ("left", "hall", "door")
            }
        ),
    )
    assert [*found.late_s] == [3]
    assert found.settings.cameras["door"].offset_s == pytest.approx(LATE_S, abs=0.01)
    assert found.settings.cameras["hall"].offset_s is None


@pytest.mark.usefixtures("ears")
def test_what_was_heard_is_said() -> None:
    from calibration.tracks.lateness import UNSEEN

    found = by_ear(clip("cam1", "cam2"), Settings())
    told = clock_facts(found.clip, (UNSEEN,), offsets_of(found.settings), found.late_s)
    assert told["clock"]["state"] == "heard"
    assert clock_words(told) == [
        "view 2 is -1.23 s late: its times were set back by that, as the sound tells"
    ]


def test_calibrating_says_what_was_heard_too() -> None:
    assert heard_words("walk", {2: -0.5}) == [
        "walk: view 2 is -0.50 s late: its times were set back by that, as the sound tells"
    ]
