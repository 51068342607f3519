"""The main job as `make demo` shows it."""

import io
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

pytest.importorskip("websockets", reason="the page is an extra: install tritrack[page]")

from visiting import visited

from common.config.settings import Settings
from common.rig.rig_file import load_rig
from recognizer import __main__ as recogniser
from recognizer import everyone
from recognizer.__main__ import model_of
from runtime.offline.lockstep import Decoders, track_clip
from runtime.store.other_run import OtherRun
from synth.motion.motions import performance
from tritrack import demo


def test_a_demo_that_names_another_posture_has_failed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit 0 only on success: it runs the whole system, and it checks what comes out."""
    monkeypatch.setattr(demo, "made_clip", lambda folder, _: folder / "clip")
    monkeypatch.setattr(demo, "live", lambda *_: {"posture": "squat"})
    with pytest.raises(demo.DemoFailed, match="performed raise_right_lateral, named squat"):
        demo.run_demo(tmp_path, False, Console(quiet=True))
    monkeypatch.setattr(demo, "live", lambda *_: {"posture": ""})
    with pytest.raises(demo.DemoFailed, match="named nothing"):
        demo.run_demo(tmp_path, False, Console(quiet=True))


def test_a_demo_takes_the_place_of_demos_alone(tmp_path: Path) -> None:
    def holds(film: str) -> None:
        told = {"run_of": {"command": "live", "footage": [film]}}
        (tmp_path / "summary.json").write_text(json.dumps(told))

    demo.refuse_other_than_demo(tmp_path)
    holds(f"/tmp/tritrack-demo-1/s90001_t1_05_{demo.POSTURE}/cam1.avi")
    demo.refuse_other_than_demo(tmp_path)
    holds("/tmp/tritrack-demo-1/people2_s90001_t1/cam1.avi")
    demo.refuse_other_than_demo(tmp_path)
    holds("/films/monday/cam1.avi")
    with pytest.raises(OtherRun, match=r"monday.*--force"):
        demo.refuse_other_than_demo(tmp_path)


def test_a_demo_of_two_names_the_posture_of_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which number has whom is not asked; one who is not named, or named as the other, is."""
    asked: list[Any] = []
    facts: dict[str, Any] = {"posture": "squat"}

    def live(settings: Settings, *_: object) -> dict[str, Any]:
        asked.append(settings)
        return facts

    monkeypatch.setattr(demo, "write_scenes", lambda folder, *_: [folder / "people2"])
    monkeypatch.setattr(demo, "live", live)
    said = Console(file=io.StringIO(), width=200)
    facts["postures"] = {"1": "squat", "4": "raise_right_lateral"}
    assert demo.run_demo(tmp_path, False, said, people=2) == facts
    assert (asked[0].people, Path(asked[0].clip).name) == ("all", "people2")
    assert isinstance(said.file, io.StringIO)
    assert said.file.getvalue().startswith(
        "making 2 people who perform raise_right_lateral and squat ...\n"
    )
    performed = "performed raise_right_lateral and squat, named"
    for named, told in (
        ({"1": "squat"}, "squat"),
        ({"1": "squat", "2": "squat"}, "squat and squat"),
        ({"1": "squat", "2": "raise_right_lateral", "3": "squat"}, "raise_right_lateral and squat"),
    ):
        facts["postures"] = named
        with pytest.raises(demo.DemoFailed, match=f"^{performed} {told}"):
            demo.run_demo(tmp_path, False, said, people=2)


@pytest.mark.slow
def test_of_two_in_the_demo_each_ones_posture_is_recognised(tmp_path: Path) -> None:
    """In lock-step, as a live run on a machine that keeps up is equal to it; who is who is told by
    where the truth has them."""
    clip = demo.made_scene(tmp_path, 2, 2)
    settings = Settings(clip=str(clip), size="320x240", people="all")
    with Decoders() as decoders:
        tracked = track_clip(settings, decoders)
    state = everyone.init(recogniser.init(model_of(settings), settings.recognizer.window_frames))
    named: dict[int, list[str]] = {}
    places: dict[int, float] = {}
    for body in tracked.bodies:
        state, posture = everyone.step(state, body, recogniser.step)
        if posture.event:
            named.setdefault(body.person, []).append(posture.event.name)
        if body.joints_m:
            places[body.person] = body.joints_m[0][0]
    with np.load(clip / "truth.npz") as truth:
        last = truth["joints3d"][-2:, 0, 0]
    for number, performed in enumerate(demo.POSTURES[:2]):
        nearest = min(places, key=lambda person: abs(places[person] - last[number]))
        assert {*named.pop(nearest)} == {performed}
    assert not named


@pytest.mark.slow
@pytest.mark.live
def test_the_demo_runs_ends_by_itself_and_leaves_nothing_but_its_run_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Run twice at once: nothing of it is tied to a port or a folder that another may hold."""
    (tmp_path / "tmp").mkdir()
    runs = [
        subprocess.Popen(
            [sys.executable, "-m", "tritrack", "demo", "--out", f"run {n}", "--json"],
            cwd=tmp_path,
            env={"TMPDIR": str(tmp_path / "tmp"), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for n in (1, 2)
    ]
    with ThreadPoolExecutor() as visitors:
        told = list(visitors.map(visited, [run.stderr for run in runs]))
    for n, run in enumerate(runs, 1):
        said, errors = run.communicate(timeout=120)
        errors = told[n - 1] + errors
        assert run.returncode == 0, errors
        facts = json.loads(said)
        assert facts["posture"] == facts["posture_meant"] == demo.POSTURE
        assert "the page: http://127.0.0.1:" in errors
        assert "the bus: tcp/127.0.0.1:" in errors
        written = {path.name for path in (tmp_path / f"run {n}").iterdir()}
        assert written == {"poses.npz", "summary.json", "posture.json", "log.txt"}
    assert list((tmp_path / "tmp").iterdir()) == []


def test_a_demo_runs_its_clip_with_pictures_on_a_page_if_one_is_wanted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def live(settings: Settings, out: Path, console: Console) -> dict[str, Any]:
        assert Path(settings.clip).parent.is_dir()
        asked.append((settings, out))
        return {"posture": demo.POSTURE}

    monkeypatch.setattr(demo, "made_clip", lambda folder, _: folder / "clip")
    monkeypatch.setattr(demo, "live", live)
    said = Console(file=io.StringIO(), width=200)
    for page, wait in ((True, False), (True, True), (False, True)):
        assert demo.run_demo(tmp_path, page, said, wait) == {"posture": demo.POSTURE}
    (first, out), (second, _), (third, _) = asked
    assert (first.pictures, first.page.wait, second.page.wait) == (True, False, True)
    assert first.size == "320x240", "its figures are of pictures of this size"
    assert (first.page.port > 0, second.page.port > 0, third.page.port) == (True, True, 0)
    assert (out, Path(first.clip).parent.exists()) == (tmp_path, False)
    assert isinstance(said.file, io.StringIO)
    lines = said.file.getvalue().splitlines()
    assert lines[:2] == [
        "making a person who performs raise_right_lateral ...",
        f"the bus: {first.bus.endpoint}",
    ]


def test_the_demos_clip_is_of_a_person_of_no_training_set_with_its_rig(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Filmed for 14 s, five times the posture, at 320x240."""
    asked: list[Any] = []
    monkeypatch.setattr(demo, "write_clip", lambda *given: asked.append(given))
    clip = demo.made_clip(tmp_path)
    assert clip == tmp_path / f"s90001_t1_05_{demo.POSTURE}"
    ((where, someone, motion, filming, take),) = asked
    assert (where, someone.name, take) == (clip, "s90001", 1)
    rig = load_rig(tmp_path / "calibration.json")
    assert (rig.width, rig.height, len(rig.cameras)) == (320, 240, 2)
    assert (filming.rig.width, filming.seed, filming.room_seed) == (320, 90_001, 90_001)
    assert (motion.posture, motion.fps) == (demo.POSTURE, 15.0)
    plain = performance(someone, demo.POSTURE, demo.TAKE)
    assert len(motion.joints_m) - len(plain.joints_m) > 4 * 15, "again and again"
    assert len(motion.joints_m) / 15 == pytest.approx(demo.MOTION_S, rel=0.5)
    demo.made_clip(tmp_path, 3)
    assert load_rig(tmp_path / "calibration.json").cameras[:2] == rig.cameras
    assert len(asked[1][3].rig.cameras) == 3
