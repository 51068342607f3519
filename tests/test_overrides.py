"""What a command line says stands above what settings say."""

from pathlib import Path

import pytest

from common.config.part_settings import SettingsError, SilhouetteSettings
from common.config.settings import Settings
from common.method import Mode
from runtime.overrides import overridden
from tritrack.commands.clip_commands import single, track


def test_what_is_not_named_stays_as_the_settings_say() -> None:
    own = Settings(mode="paper", size="128x96", landmarks="none")
    assert overridden(own, None, None) == own
    named = overridden(own, "default", "320x240", "mediapipe")
    assert (named.mode, named.size, named.landmarks) == ("default", "320x240", "mediapipe")


@pytest.mark.parametrize(
    ("own_s", "named_s", "found_s"),
    [(0.25, None, 0.25), (0.25, 0.0, 0.0), (None, -0.5, -0.5), (None, None, None)],
)
def test_an_offset_that_is_named_goes_before_that_of_the_settings(
    own_s: float | None, named_s: float | None, found_s: float | None
) -> None:
    """Also none at all: it is not looked for then."""
    found = overridden(Settings(offset_s=own_s), None, None, None, named_s)
    assert found.offset_s == found_s


def test_what_no_run_could_mean_is_refused() -> None:
    with pytest.raises(SettingsError, match="landmarks must be own, none, mediapipe or a folder"):
        overridden(Settings(), None, None, "")


def test_a_run_works_without_a_background_where_landmarks_show_the_person() -> None:
    named = overridden(Settings(), None, None, background="none")
    assert named.silhouette == SilhouetteSettings(background="none")
    assert overridden(named, None, None).silhouette == named.silhouette
    with pytest.raises(SettingsError, match="background must be none, got 'room"):
        overridden(Settings(), None, None, background="room.png")


@pytest.mark.parametrize(("mode", "landmarks"), [("paper", "own"), ("default", "none")])
def test_without_a_background_and_without_landmarks_no_person_can_be_seen(
    mode: Mode, landmarks: str
) -> None:
    with pytest.raises(SettingsError, match="without a background only landmarks show a person"):
        overridden(Settings(), mode, None, landmarks, background="none")


def test_everyone_or_one_person_is_followed() -> None:
    everyone = overridden(Settings(), None, None, people="all")
    assert everyone.people == "all"
    assert overridden(everyone, None, None).people == "all"
    assert overridden(everyone, None, None, people="1").people == 1


@pytest.mark.parametrize(
    ("mode", "landmarks"), [("paper", "own"), ("default", "none"), ("default", "mediapipe")]
)
def test_everyone_is_followed_by_landmarks_of_ours_alone(mode: Mode, landmarks: str) -> None:
    with pytest.raises(SettingsError, match="needs mode default and a landmark network of ours"):
        overridden(Settings(), mode, None, landmarks, people="all")


@pytest.mark.parametrize("named", ["README.md", "nope", "nope.onnx"])
def test_landmarks_that_are_not_there_are_told_as_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("README.md").touch()
    with pytest.raises(SettingsError, match=f"there is no folder or network {named} of landmarks"):
        overridden(Settings(), None, None, named)


@pytest.mark.slow
def test_track_looks_by_the_landmarks_that_are_named(clip: Path, tmp_path: Path) -> None:
    """Of both, that of the command counts."""
    file = tmp_path / "said.toml"
    file.write_text(f'clip = "{clip}"\nlandmarks = "none"\n')
    track([file, clip], tmp_path / "runs")
    track([clip], tmp_path / "without", landmarks="none")
    said, plain = (poses(tmp_path / "runs" / name) for name in ("said", clip.name))
    assert poses(tmp_path / "without" / clip.name) == said != plain
    track([file], tmp_path / "with", landmarks="own")
    assert poses(tmp_path / "with" / "said") == plain


@pytest.mark.slow
def test_single_looks_by_the_landmarks_that_are_named(clip: Path, tmp_path: Path) -> None:
    video = next(clip.glob("cam1.*"))
    file = tmp_path / "said.toml"
    file.write_text(f'landmarks = "none"\n[cameras.cam1]\nsource = "{video}"\n')
    single([file], tmp_path / "runs", size="160x120")
    single([video], tmp_path / "runs", size="160x120", landmarks="none")
    assert poses(tmp_path / "runs" / "cam1") == poses(tmp_path / "runs" / "said")


def poses(run: Path) -> bytes:
    return (run / "poses.npz").read_bytes()
