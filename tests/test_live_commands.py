"""What is typed for a live run reaches its processes; no other run is lost unasked."""

from pathlib import Path
from typing import Any

import msgspec
import pytest
from typed import Called, instead, typed

from common.config.part_settings import CameraSettings, PageSettings, SettingsError
from common.config.settings import Settings
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.clip_sources import ClipError
from runtime.live.admission import LiveRefused
from runtime.store.other_run import OtherRun, run_of
from runtime.store.runs import write_run
from tritrack.commands import live_commands
from tritrack.commands.live_commands import (
    animate,
    bridge,
    demo,
    integrate,
    live,
    metrics,
    recognize,
    serve,
    view,
    waiting,
)

CAMERAS = Settings(cameras={"cam1": CameraSettings(device=0), "cam2": CameraSettings(device=1)})
VIEWS = tuple(ClipView(n, n, (160, 120), (160, 120), 30.0, 0) for n in (1, 2))
CLIP = Clip("room", VIEWS, 2, None, Meta())


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(live_commands, "refuse_without", lambda *_: None)
    (tmp_path / "gym.toml").write_text("")
    return tmp_path


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Called:
    """What settings files say."""
    return instead(monkeypatch, "tritrack.commands.live_commands.config_file.load", CAMERAS)


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> Called:
    return instead(monkeypatch, "runtime.live.session.live", {"posture": "squat"})


def test_a_live_run_is_that_of_its_settings_and_what_is_typed(given: Called, ran: Called) -> None:
    words = ["--mode", "paper", "--size", "160x120", "--landmarks", "none", "--record", "--no-wait"]
    said = typed(live, "gym.toml", "--out", "new", *words, "--record-pictures")
    settings, out, _, name, record, pictures = ran.last
    assert pictures
    assert (settings.mode, settings.size, settings.landmarks) == ("paper", "160x120", "none")
    assert (out, name, record, settings.page.wait) == (Path("new"), "gym", True, False)
    assert "posture: squat; written to new" in said.output
    ran.answer = {"posture": ""}
    said = typed(live, "somewhere")
    settings, out, _, name, record, pictures = ran.last
    assert (out, name, record, pictures) == (live_commands.LAST, "", False, False)
    assert settings.page.wait is Settings().page.wait
    assert "posture: none; written to runs/live" in said.output
    assert settings.people == 1
    ran.answer = {"posture": "squat", "postures": {"1": "kick_left_side", "2": "squat"}}
    said = typed(live, "somewhere", "--people", "all")
    assert ran.last[0].people == "all"
    assert "postures: kick_left_side by 1, squat by 2; written to runs/live" in said.output


def test_another_run_is_written_over_only_where_the_last_one_always_is(
    given: Called, ran: Called, here: Path
) -> None:
    other = run_of("track", ["dance.mp4"])
    for folder in (here / "mine", here / "runs/live"):
        folder.mkdir(parents=True)
        write_run(folder, [], Settings(), other.facts)
    with pytest.raises(OtherRun):
        typed(live, "gym.toml", "--out", "mine")
    assert not ran.given
    typed(live, "gym.toml", "--out", "mine", "--force")
    said = typed(live, "gym.toml")
    assert "runs/live holds another run (tritrack track of" in said.output
    assert len(ran.given) == 2
    write_run(here / "runs/live", [], Settings(), run_of("live", [0, 1]).facts)
    assert "another run" not in typed(live, "gym.toml").output
    (here / "runs/live/pictures").mkdir()
    with pytest.raises(LiveRefused, match="pictures holds what cameras showed in another run"):
        typed(live, "gym.toml")
    typed(live, "gym.toml", "--force")
    assert len(ran.given) == 4


def test_the_demo_is_shown_unless_it_is_told_not_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    done = instead(monkeypatch, "tritrack.demo.run_demo", {"posture": "squat"})
    refused = instead(monkeypatch, "tritrack.demo.refuse_other_than_demo")
    said = typed(demo, "--no-page", "--no-wait", "--out", "new")
    assert (done.last[:2], done.last[3]) == ((Path("new"), False), False)
    assert refused.last == (Path("new"),)
    assert "posture: squat; written to new" in said.output
    typed(demo, "--force", "--cameras", 3)
    assert (done.last[:2], done.last[3:]) == ((Path("runs/demo"), True), (True, 3, 1))
    typed(demo, "--force", "--people", 2)
    assert done.last[3:] == (True, 2, 2)
    assert len(refused.given) == 1


def test_each_process_of_a_rig_over_hosts_gets_the_settings_of_its_file(
    monkeypatch: pytest.MonkeyPatch, given: Called
) -> None:
    mains = {
        name: instead(monkeypatch, place)
        for name, place in {
            "viewer": "viewer.__main__.main",
            "integrator": "integrator.__main__.main",
            "recognizer": "recognizer.__main__.main",
            "animator": "animator.__main__.main",
            "metrics": "runtime.outside.metrics_process.main",
        }.items()
    }
    instead(monkeypatch, "runtime.live.elsewhere.whole_clip", CLIP)
    measured: Any = object()
    instead(monkeypatch, "runtime.offline.lockstep.measured_before", measured)
    held = instead(monkeypatch, "runtime.live.free_ports.refuse_held_page")
    typed(view, "gym.toml", "--viewer", 2)
    typed(integrate, "gym.toml")
    typed(recognize, "gym.toml")
    typed(animate, "gym.toml")
    assert given.last == (Path("gym.toml"),)
    assert mains["viewer"].last == (CAMERAS, 2)
    settings, clip = mains["integrator"].last
    assert (settings, clip.body, clip.views) == (CAMERAS, measured, VIEWS)
    assert mains["recognizer"].last == (CAMERAS, 2 / 30.0)
    assert mains["animator"].last == held.last == (CAMERAS,)

    with pytest.raises(SettingsError, match=r'gym\.toml has no metrics: add metrics = "127'):
        typed(metrics, "gym.toml")
    given.answer = msgspec.structs.replace(CAMERAS, metrics="127.0.0.1:9")
    free = instead(monkeypatch, "runtime.live.free_ports.refuse_held_metrics")
    typed(metrics, "gym.toml")
    assert free.last == ("127.0.0.1:9",)
    names = ("integrator", "recognizer", "viewer 1", "viewer 2")
    assert mains["metrics"].last == (given.answer, names)

    given.answer = msgspec.structs.replace(CAMERAS, mode="thesis")
    for command in (integrate, recognize, animate, metrics):
        with pytest.raises(LiveRefused):
            typed(command, "gym.toml")


def test_sites_are_served_from_their_file(monkeypatch: pytest.MonkeyPatch) -> None:
    served = instead(monkeypatch, "runtime.serving.serve.serve")
    typed(serve, "sites.toml")
    assert served.last[0] == Path("sites.toml")


@pytest.mark.parametrize("own", [True, False])
@pytest.mark.parametrize("asked", [True, False])
def test_a_run_waits_for_its_page_where_both_say_so(own: bool, asked: bool) -> None:
    settings = Settings(page=PageSettings(port=9000, wait=own))
    found = waiting(settings, asked)
    assert found.page == PageSettings(port=9000, wait=own and asked)


@pytest.mark.parametrize(
    ("protocol", "words", "to"),
    [
        ("osc", [], "127.0.0.1:9000"),
        ("vmc", [], "127.0.0.1:39539"),
        ("lsl", [], "127.0.0.1:9000"),
        ("vmc", ["--to", "h:1"], "h:1"),
    ],
)
def test_poses_are_sent_where_the_protocol_is_heard(
    monkeypatch: pytest.MonkeyPatch, protocol: str, words: list[str], to: str
) -> None:
    sent = instead(monkeypatch, "runtime.bridges.bridging.bridge", 1)
    more = ["--endpoint", "tcp/h:7", "--room", "gym", "--keys", "k"]
    said = typed(bridge, protocol, *words, *more)
    assert (*sent.last[:4], sent.last[5]) == (protocol, "tcp/h:7", "gym", to, "k")
    assert "1 body sent" in said.output
    typed(bridge, protocol, *words)
    assert sent.last[1:3] == (Settings().bus.endpoint, Settings().room)


def test_the_page_is_asked_for_where_it_is_shown_and_footage_before_a_run(
    monkeypatch: pytest.MonkeyPatch, given: Called, ran: Called
) -> None:
    lacks = instead(monkeypatch, "tritrack.commands.live_commands.refuse_without")
    instead(monkeypatch, "tritrack.demo.run_demo", {"posture": "squat"})
    typed(demo, "--no-page", "--force")
    assert lacks.given == []
    typed(demo, "--force")
    assert lacks.given == [("page", "websockets")]
    given.answer = Settings()
    with pytest.raises(ClipError, match=r"gym\.toml: there is nothing to look at"):
        typed(live, "gym.toml")
    given.answer = Settings(clip="nowhere")
    with pytest.raises(ClipError, match="there is no clip folder nowhere"):
        typed(view, "gym.toml", "--viewer", 1)
    assert not ran.given
