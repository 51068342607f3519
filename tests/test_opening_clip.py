"""A clip of its own for the opening posture: the body is known before the run begins (P46)."""

from pathlib import Path

import pytest

from common.body.proportions import thesis_bdp
from common.bus.messages import Body
from common.config import config_file
from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.video.clip_sources import ClipError
from runtime.offline.lockstep import Decoders, Tracked, measured_before, track_clip
from runtime.offline.opening_clip import body_of

PERSON = thesis_bdp(1.62)


def bodies(*known: bool) -> list[Body]:
    return [
        Body(
            frame=n,
            captured_s=n / 15,
            clock_s=n / 15,
            status="tracking",
            views="both",
            facing=("facade", "flank"),
            bdp=PERSON if one else None,
        )
        for n, one in enumerate(known)
    ]


def test_no_opening_clip_tells_nothing_and_none_is_opened() -> None:
    assert measured_before(Settings()) is None


def test_the_opening_clip_is_looked_at_as_the_run_is(tmp_path: Path) -> None:
    """Its mode and size are the run's; what it knows last is the body."""
    asked: list[Settings] = []

    def track(own: Settings) -> list[Body]:
        asked.append(own)
        return bodies(False, True)

    run = Settings(opening=str(tmp_path), mode="paper", size="320x240")
    assert body_of(run, track) == PERSON
    assert (asked[0].clip, asked[0].mode, asked[0].size) == (str(tmp_path), "paper", "320x240")


def test_an_opening_clip_without_anybody_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="nobody is seen in the opening clip"):
        body_of(Settings(opening=str(tmp_path)), lambda _: bodies(False))


def test_an_opening_clip_has_none_itself(tmp_path: Path) -> None:
    file = tmp_path / "tpose.toml"
    file.write_text('opening = "other"\n')
    with pytest.raises(SettingsError, match="an opening clip has none itself"):
        body_of(Settings(opening=str(file)), lambda _: bodies(True))


def test_the_opening_is_named_from_where_the_settings_are(tmp_path: Path) -> None:
    file = tmp_path / "run.toml"
    file.write_text('clip = "walk"\nopening = "tpose"\n')
    assert config_file.load(file).opening == str(tmp_path / "tpose")


def test_a_missing_opening_clip_is_named(clip: Path) -> None:
    with (
        Decoders() as decoders,
        pytest.raises((ClipError, SettingsError), match=r"^opening = .*no_such"),
    ):
        track_clip(Settings(clip=str(clip), opening=str(clip.parent / "no_such")), decoders)


@pytest.mark.slow
def test_a_run_knows_the_body_from_its_first_frame_on(clip: Path, tracked_clip: Tracked) -> None:
    known = tracked_clip.bodies[-1].bdp
    with Decoders() as decoders:
        done = track_clip(Settings(clip=str(clip), opening=str(clip)), decoders)
    first = next(body for body in done.bodies if body.status != "empty")
    assert known is not None
    assert first.bdp is not None
    assert first.status == "tracking"
    assert first.bdp.torso.height == pytest.approx(known.torso.height)
    assert not any("opening posture" in warning for warning in done.facts["warnings"])
