"""The settings of each part: what is just allowed, what just is not, and what is said of it."""

from typing import Any

import pytest

from common.config.part_settings import (
    BodySettings,
    BusSettings,
    CameraSettings,
    PageSettings,
    RecognizerSettings,
    SearchSettings,
    SettingsError,
    SilhouetteSettings,
    within,
)
from common.config.settings import Settings

BOUNDS: list[tuple[Any, str, Any, Any, Any, Any]] = [
    (SilhouetteSettings, "empty_frames", 0, 1000, -1, 1001),
    (SilhouetteSettings, "empty_s", 0.01, 100.0, 0.009, 100.1),
    (SilhouetteSettings, "min_height_share", 0.01, 1.0, 0.009, 1.01),
    (BodySettings, "stature_m", 0.5, 2.6, 0.49, 2.61),
    (BodySettings, "opening_frames", 1, 100, 0, 101),
    (RecognizerSettings, "window_frames", 5, 600, 4, 601),
    (PageSettings, "port", 0, 65535, -1, 65536),
    (Settings, "every", 1, 1000, 0, 1001),
    (Settings, "fps", 0.0, 1000.0, -0.1, 1000.1),
    (Settings, "offset_s", -3600.0, 3600.0, -3600.1, 3600.1),
]


@pytest.mark.parametrize(("kind", "name", "low", "high", "below", "above"), BOUNDS)
def test_a_number_is_taken_up_to_its_bounds_and_named_beyond_them(
    kind: Any, name: str, low: Any, high: Any, below: Any, above: Any
) -> None:
    for value in (low, high):
        held = getattr(kind(**{name: value}), name)
        assert held == (0 if name == "empty_frames" else value)
    for value in (below, above):
        with pytest.raises(
            ValueError, match=rf"^{name} must be from {low} to {high}, got {value}$"
        ):
            kind(**{name: value})


def test_within_takes_its_ends() -> None:
    within("it", 2, 2, 3)
    within("it", 3, 2, 3)
    with pytest.raises(ValueError, match=r"^it must be from 2 to 3, got 4$"):
        within("it", 4, 2, 3)
    with pytest.raises(ValueError, match="got nan"):
        within("it", float("nan"), 2, 3)


def test_the_empty_room_in_frames_is_told_in_seconds_of_fifteen() -> None:
    """What settings said before there were seconds."""
    told = SilhouetteSettings(empty_frames=6, empty_s=9.0)
    assert (told.empty_s, told.empty_frames) == (0.4, 0)
    assert (SilhouetteSettings().empty_s, SilhouetteSettings().min_height_share) == (0.5, 0.15)


def test_a_view_has_one_source() -> None:
    CameraSettings(source="a.avi")
    CameraSettings(device=0)
    with pytest.raises(ValueError, match="offset_s must be from"):
        CameraSettings(offset_s=4000.0)
    with pytest.raises(ValueError, match=r"^source and device are both set: a\.avi, 0$"):
        CameraSettings(source="a.avi", device=0)


@pytest.mark.parametrize("name", ["arm_window_deg", "leg_window_deg"])
def test_a_searchs_width_halves_down_to_its_stop(name: str) -> None:
    for width, stop in ((8, 4), (16, 4), (64, 4), (12, 6), (2, 1)):
        other = "leg_window_deg" if name == "arm_window_deg" else "arm_window_deg"
        assert (
            getattr(SearchSettings(**{name: width, other: 4 * stop}, stop_deg=stop), name) == width
        )
    for width, stop in ((4, 4), (12, 4), (6, 4), (64, 0), (64, -4), (-64, 4)):
        with pytest.raises(ValueError, match="must be stop_deg times 2, 4, 8"):
            SearchSettings(**{name: width}, stop_deg=stop)
    with pytest.raises(ValueError, match=rf"^{name} must be .*, got 48$"):
        SearchSettings(**{name: 48})


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("host", "", "host must be a plain name or address, got ''"),
        ("host", "a b", "host must be a plain name or address, got 'a b'"),
        ("name", "rig/x", "name must be a plain name or address, got 'rig/x'"),
    ],
)
def test_a_page_listens_at_a_plain_name(name: str, value: Any, said: str) -> None:
    with pytest.raises(ValueError, match=f"^{said}$"):
        PageSettings(**{name: value})
    assert PageSettings(host="0.0.0.0", name="rig.example").name == "rig.example"


def test_a_session_is_a_word_of_at_most_64_letters() -> None:
    assert BusSettings(session="a" * 64).session == "a" * 64
    for word in ("a" * 65, "ä"):
        with pytest.raises(
            ValueError, match=f"^session must be at most 64 ASCII letters, got '{word}"
        ):
            BusSettings(session=word)


@pytest.mark.parametrize(
    ("endpoint", "keys", "open_to_all", "said"),
    [
        ("tcp/127.0.0.1:7447", "", False, ""),
        ("auto", "", False, ""),
        ("auto", "here", False, ""),
        ("tls/192.168.1.5:7447", "here", False, ""),
        ("tcp/192.168.1.5:7447", "", True, ""),
        (
            "7447",
            "",
            False,
            r"endpoint must look like tcp/127\.0\.0\.1:7447, or be auto, got '7447'",
        ),
        ("tls/127.0.0.1:7447", "", False, "keys go with an endpoint tls/HOST:PORT, it with keys"),
        ("tcp/127.0.0.1:7447", "here", False, "got endpoint 'tcp/127.0.0.1:7447', keys 'here'"),
        ("tcp/192.168.1.5:7447", "", False, "whoever reaches tcp/192.168.1.5:7447 could hear and"),
    ],
)
def test_a_bus_that_others_reach_has_keys_or_is_open_by_wish(
    endpoint: str, keys: str, open_to_all: bool, said: str
) -> None:
    if not said:
        assert BusSettings(endpoint, keys=keys, open_to_all=open_to_all).endpoint == endpoint
    else:
        with pytest.raises(SettingsError, match=said):
            BusSettings(endpoint, keys=keys, open_to_all=open_to_all)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"room": ""}, "room must be a plain word, got ''"),
        *(({"room": f"a{sign}b"}, "room must be a plain word, got") for sign in "/*$#? "),
        ({"size": "160"}, "size must look like 160x120, got '160'"),
        ({"landmarks": ""}, "landmarks must be own, none, mediapipe or a folder or network"),
        ({"metrics": "9464"}, "metrics must look like 127.0.0.1:9464, got '9464'"),
    ],
)
def test_settings_of_a_run_that_cannot_be_are_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Settings(**wrong)


def test_viewers_look_by_a_network_of_ours_alone() -> None:
    looks = {name: Settings(landmarks=name).looks_itself for name in ("own", "none", "mediapipe")}
    assert looks == {"own": True, "none": False, "mediapipe": False}
    assert Settings(landmarks="mine.onnx").looks_itself
    assert not Settings(landmarks="own.d").looks_itself
    assert Settings(metrics="localhost:9464", offset_s=None).offset_s is None
