"""Settings in the words of 0.2: read for one version, with a word on the new ones."""

import warnings
from pathlib import Path

import pytest

from common.config.config_file import load
from common.config.part_settings import SettingsError
from common.config.renamed_settings import RenamedSetting, in_new_words, settings_of

OLD = """
[camera_2]
device = 5
[camera_1]
source = "walk.avi"
calibrated_as = "left"
"""
NEW = OLD.replace("camera_", "cameras.cam")


def written(folder: Path, text: str) -> Path:
    path = folder / "run.toml"
    path.write_text(text)
    return path


def test_cameras_of_before_are_read_as_cam1_and_cam2_with_a_warning(tmp_path: Path) -> None:
    with pytest.warns(RenamedSetting) as told:
        old = load(written(tmp_path, OLD))
    assert [str(one.message) for one in told] == [
        f"{tmp_path / 'run.toml'}: [camera_{n}] is now [cameras.cam{n}]; 0.4 will not read the old "
        "name"
        for n in (1, 2)
    ]
    assert issubclass(RenamedSetting, DeprecationWarning)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load(written(tmp_path, NEW)) == old
    assert old.cameras["cam1"].source == str(tmp_path / "walk.avi")
    assert old.cameras["cam2"].device == 5


def test_both_spellings_of_one_camera_are_refused(tmp_path: Path) -> None:
    text = "[camera_1]\ndevice = 0\n[cameras.cam1]\ndevice = 1"
    with (
        pytest.warns(RenamedSetting),
        pytest.raises(
            SettingsError, match=r"run\.toml: \[camera_1\] and \[cameras\.cam1\] are one"
        ),
    ):
        load(written(tmp_path, text))


def test_old_and_new_cameras_go_together() -> None:
    both = {"camera_2": {"device": 2}, "cameras": {"door": {"device": 0}}, "every": 2}
    settings = settings_of(both)
    assert {name: one.device for name, one in settings.cameras.items()} == {"cam2": 2, "door": 0}
    assert settings.every == 2


def test_what_a_run_of_before_wrote_where_it_had_no_camera_is_none() -> None:
    assert settings_of({"clip": "walk", "camera_1": None, "camera_2": None}).cameras == {}
    assert in_new_words("no settings") == "no settings"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[camera_1]\nsorce = 'a'", r"cameras\.cam1: unknown setting sorce \(did you mean source"),
        ("camera_2 = 3", r"cameras\.cam2: it must be a table, got a whole number"),
        ("cameras = [1]\n[camera_1]\ndevice = 0", "cameras must be a table, got a list"),
        ("[cameras.'le ft']\ndevice = 0", r"A-Z a-z 0-9 _ and -, got 'le ft'"),
    ],
)
@pytest.mark.filterwarnings("ignore::common.config.renamed_settings.RenamedSetting")
def test_what_is_wrong_with_a_camera_is_told_by_its_name(
    tmp_path: Path, text: str, said: str
) -> None:
    with pytest.raises(SettingsError, match=said):
        load(written(tmp_path, text))
