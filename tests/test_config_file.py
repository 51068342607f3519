"""Settings, held against what a person may write in a file."""

import re
from pathlib import Path

import pytest

from common.config import config_file
from common.config.config_file import load, with_absolute_paths
from common.config.part_settings import CameraSettings, SettingsError
from common.config.settings import Settings

CONFIGS = Path(__file__).parents[1] / "configs"
RUNS = sorted(path for path in CONFIGS.glob("*.toml") if "tritrack live" in path.read_text())


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "run.toml"
    path.write_text(text)
    return path


def refused(tmp_path: Path, text: str) -> str:
    with pytest.raises(SettingsError) as caught:
        load(written(tmp_path, text))
    message = str(caught.value)
    assert "\n" not in message
    assert "run.toml" in message
    return message


def test_an_empty_file_is_all_defaults(tmp_path: Path) -> None:
    assert load(written(tmp_path, "")) == Settings()


@pytest.mark.parametrize("path", RUNS, ids=lambda path: path.stem)
def test_the_settings_that_are_shipped_load(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TRITRACK_DATA", "/clips")
    assert load(path) != Settings()


def test_some_settings_are_shipped() -> None:
    assert len(RUNS) >= 2


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("rooom = 'x'", r"unknown setting rooom \(did you mean room\?\)"),
        ("[search]\nstop = 4", r"unknown setting search\.stop \(did you mean stop_deg"),
        (
            "[cameras.left]\nsorce = 'a'",
            r"run\.toml: cameras\.left: unknown setting sorce .did you",
        ),
        ("every = 'two'", "every must be a whole number, got text"),
        ("[page]\nport = 1.5", r"page\.port must be a whole number"),
        ("mode = 'quick'", "mode must be default, paper or thesis, got 'quick'"),
        ("room = ", "run.toml"),
    ],
)
def test_what_is_misspelt_or_ill_typed_is_refused_with_its_place(
    tmp_path: Path, text: str, place: str
) -> None:
    assert re.search(place, refused(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("every = 0", "got 0"),
        ("room = 'a/b'", "a/b"),
        ("room = ''", "plain word"),
        ("size = '160'", "look like 160x120"),
        ("metrics = '9464'", "look like 127.0.0.1:9464"),
        ("metrics = 'localhost:0'", "look like 127.0.0.1:9464"),
        ("size = '16x120'", "size must be from 32x32 to 4096x4096 pixels, got 16x120"),
        ("[page]\nport = 70000", "got 70000"),
        ("landmarks = ''", "must be own, none, mediapipe or a folder"),
        ("landmarks = 'mediapip'", "no folder .*mediapip of landmarks.*own, none, mediapipe"),
        ("landmarks = '$NO_SUCH_VARIABLE/x'", "export it"),
        ("[body]\nstature_m = 3.0", "got 3.0"),
        ("[body]\nopening_frames = 0", "got 0"),
        ("[silhouette]\nmin_height_share = nan", "nan"),
        ("[silhouette]\nempty_s = 0.0", "empty_s must be from 0.01 to 100.0, got 0.0"),
        ("offset_s = 4000.0", "offset_s must be from -3600.0 to 3600.0, got 4000.0"),
        ("[search]\narm_window_deg = 60", "arm_window_deg.*got 60"),
        ("[search]\nstop_deg = 0", "got 64"),
        ("[search]\nleg_window_deg = 4", "leg_window_deg"),
        ("[recognizer]\nwindow_frames = 1", "got 1"),
        ("[cameras.cam1]\nsource = 'a'\ndevice = 0", "cameras.cam1: .*both set"),
        ("[bus]\nendpoint = 'tcp/192.168.1.5:7447'", "tcp/192.168.1.5:7447.*tritrack keys FOLDER"),
        ("[bus]\nendpoint = 'tcp/0.0.0.0:7447'", "or set open_to_all = true"),
        ("[page]\nhost = ''", "host must be a plain name or address, got ''"),
        ("[page]\nname = 'https://rig'", "got 'https://rig'"),
        (f"[page]\nhost = '{'a' * 70}'", "host must be a plain name or address, got 'aaa"),
        ('[page]\nname = "a\\u0000b"', "name must be a plain name or address"),
        (f"metrics = '{'a' * 70}:9464'", "look like 127.0.0.1:9464"),
        ("[bus]\nendpoint = '7447'", "bus: endpoint must look like tcp/127.0.0.1:7447"),
        ("[bus]\nendpoint = 'tcp/127.0.0.1'", "must look like tcp/127.0.0.1:7447"),
        ("[bus]\nendpoint = 'tcp/127.0.0.1:70000'", "got 'tcp/127.0.0.1:70000'"),
        (f"[bus]\nendpoint = 'tcp/{'a' * 70}:7447'", "must look like tcp/127.0.0.1:7447"),
        ("[bus]\nkeys = 'keys'", "keys go with an endpoint tls/HOST:PORT"),
        ("[bus]\nendpoint = 'tls/rig.local:7447'", "it with keys .tritrack keys FOLDER"),
    ],
)
def test_what_no_run_could_mean_is_refused_with_what_was_got(
    tmp_path: Path, text: str, number: str
) -> None:
    """P36: a window halves down to its stop on whole degrees, else the grid is not exact."""
    assert re.search(number, refused(tmp_path, text))


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="there is no clip folder and no settings file"):
        load(tmp_path / "none.toml")


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.toml"
    path.write_bytes(b"room = '\xff\xfe'")
    with pytest.raises(SettingsError, match=r"run\.toml"):
        load(path)


def test_a_folder_is_a_clip(tmp_path: Path) -> None:
    assert load(tmp_path) == Settings(clip=str(tmp_path))


def test_paths_are_relative_to_the_file_and_variables_are_filled_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CLIPS", "/elsewhere")
    monkeypatch.setenv("NAME", "kick")
    text = """
        clip = "$CLIPS/$NAME"
        calibration = "here.json"
        [cameras.cam1]
        source = "clips/${NAME}.mp4"
        background = "/plates/empty.png"
        [recognizer]
        model = "own.model"
        [bus]
        endpoint = "tls/rig.local:7447"
        keys = "keys"
    """
    settings = load(written(tmp_path, text))
    assert settings.bus.keys == str(tmp_path / "keys")
    assert settings.clip == "/elsewhere/kick"
    assert settings.calibration == str(tmp_path / "here.json")
    assert [*settings.cameras] == ["cam1"]
    camera = settings.cameras["cam1"]
    assert camera.source == str(tmp_path / "clips" / "kick.mp4")
    assert camera.background == "/plates/empty.png"
    assert settings.recognizer.model == str(tmp_path / "own.model")


def test_landmarks_are_a_word_or_a_folder_beside_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TAKE", "pose_1")
    (tmp_path / "pose_1").mkdir()
    for word in ("own", "none", "mediapipe"):
        assert load(written(tmp_path, f"landmarks = '{word}'")).landmarks == word
    folder = load(written(tmp_path, "landmarks = '$TAKE'")).landmarks
    assert folder == str(tmp_path / "pose_1")


def test_a_network_of_ones_own_is_a_file_beside_the_settings(tmp_path: Path) -> None:
    named = written(tmp_path, "landmarks = 'mine.onnx'")
    with pytest.raises(SettingsError, match=r"no network .*mine\.onnx of landmarks"):
        load(named)
    (tmp_path / "mine.onnx").write_bytes(b"")
    assert load(named).landmarks == str(tmp_path / "mine.onnx")
    assert load(named).looks_itself


def test_a_clip_folder_has_our_own_landmarks(tmp_path: Path) -> None:
    assert load(tmp_path).landmarks == "own"


def test_a_video_is_told_from_a_settings_file(tmp_path: Path) -> None:
    for content in (b"RIFF\xfd\xff", b"YUV4MPEG2 W2 H2\nFRAME\n\x00\x01"):
        (tmp_path / "dance.avi").write_bytes(content)
        with pytest.raises(
            SettingsError,
            match=r"dance\.avi is no settings file: name a TOML file, or the folder that holds "
            r"cam1\.\* and cam2\.\*; of one video: tritrack single .*/dance\.avi$",
        ):
            load(tmp_path / "dance.avi")


def test_of_a_long_video_only_the_beginning_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(config_file, "MOST_BYTES", 8)
    (tmp_path / "long.toml").write_text("fps = 15\n" + "?" * 1000)
    assert load(tmp_path / "long.toml").fps == 15


def test_a_variable_that_is_not_set_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NOWHERE", raising=False)
    (tmp_path / "live.toml").write_text('clip = "$NOWHERE/walk"')
    with pytest.raises(SettingsError, match=r"\$NOWHERE/walk names a variable that is not set"):
        load(tmp_path / "live.toml")


def test_a_bus_that_others_reach_without_keys_must_be_wanted(tmp_path: Path) -> None:
    text = "[bus]\nendpoint = 'tcp/192.168.1.5:7447'\nopen_to_all = true"
    assert load(written(tmp_path, text)).bus.open_to_all


def test_what_a_run_keeps_of_its_settings_has_absolute_paths(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sign that a settings file takes for a variable stays; a word is no path."""
    monkeypatch.chdir(tmp_path)
    camera = CameraSettings(source="one $5.avi", background="/rooms/empty.png")
    kept = with_absolute_paths(Settings(clip="walk", opening="t.avi", cameras={"cam1": camera}))
    assert (kept.clip, kept.opening) == (str(tmp_path / "walk"), str(tmp_path / "t.avi"))
    assert kept.cameras["cam1"].source == str(tmp_path / "one $5.avi")
    assert kept.cameras["cam1"].background == "/rooms/empty.png"
    assert (kept.calibration, kept.landmarks, kept.recognizer.model) == ("", "own", "")
    own = with_absolute_paths(Settings(landmarks="points"))
    assert own.landmarks == str(tmp_path / "points")
    assert with_absolute_paths(kept) == kept


def test_a_file_whose_own_name_has_a_dollar_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The start page writes settings that name files as they are."""
    monkeypatch.setenv("HOME", "/elsewhere")
    for name in ("my $5 runs", "of $HOME"):
        (tmp_path / name).mkdir()
        assert load(written(tmp_path, f"clip = '{name}'")).clip == str(tmp_path / name)
        assert load(written(tmp_path, f"clip = '{tmp_path / name}'")).clip == str(tmp_path / name)
    assert load(written(tmp_path, "clip = '$HOME/walk'")).clip == "/elsewhere/walk"
