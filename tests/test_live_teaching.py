"""Teaching before cameras: three takes that agree are learnt, others are done again."""

import io
from pathlib import Path

import pytest
from acting import perform
from rich.console import Console

from common.bus.messages import Body
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from lab.posture_models.learning import train
from lab.posture_models.lesson import taught
from lab.training import live_teaching
from lab.training.coach import Said
from lab.training.live_teaching import MOST_TAKES, Teaching, teach_live
from lab.training.training import Plan, TrainingError
from recognizer.model_file import load, save
from recognizer.postures import Recognizer
from runtime.live.launch import nothing_heard
from synth.motion.streaming import streamed
from synth.person.people import person
from synth.picture.exposure import default_rig
from synth.write import FPS, Filming, write_clip, write_rig

NEW = "raise_both_lateral"
KNOWN = ("squat", "walk_toward", "kick_left_side")


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    """Added to a model of a few postures: the shipped one knows all that can act."""
    folder = tmp_path_factory.mktemp("known")
    save(train({name: [perform(name, n) for n in range(3)] for name in KNOWN}), folder / "few.npz")
    return Plan(None, "default", folder, folder / "few.npz")


def taught_by(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, *postures: str
) -> tuple[Teaching, list[str]]:
    """A teaching that cuts these performances out of what it sees, one a body."""
    takes = [perform(posture, n) for n, posture in enumerate(postures)]
    monkeypatch.setattr(
        "lab.training.coach.step", lambda state, _: (state, Said(take=takes.pop(0)))
    )
    console = Console(record=True, width=200, file=io.StringIO())
    teaching = Teaching(NEW, load(plan.add_to), console, 0.0)
    heard = nothing_heard()
    for n in range(len(postures)):
        heard.bodies.add(
            [Body(frame=n, captured_s=float(n), clock_s=0.0, status="empty", views="none")]
        )
        if teaching(heard):
            break
    return teaching, console.export_text().splitlines()


def test_three_takes_that_agree_end_the_run(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    teaching, said = taught_by(plan, monkeypatch, NEW, NEW, NEW, "squat")
    assert teaching.lesson is not None
    assert teaching.lesson.model.names == (*KNOWN, NEW)
    assert said[-1] == "three takes that agree: learnt"


def test_a_take_that_differs_is_named_and_done_again(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    teaching, said = taught_by(plan, monkeypatch, NEW, NEW, "squat", NEW)
    assert "take 3 looks like squat: once more" in said
    assert teaching.lesson is not None
    assert len(teaching.lesson.takes) == 3


def test_who_never_shows_one_motion_is_not_waited_for_for_ever(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = ("squat", "walk_toward", "kick_left_side") * MOST_TAKES
    teaching, said = taught_by(plan, monkeypatch, *shown)
    assert teaching.lesson is None
    assert sum("all over again" in line for line in said) >= 1
    assert sum(line.startswith("take ") for line in said) <= MOST_TAKES


@pytest.mark.parametrize(("kind", "learns"), [("default", True), ("paper", False)])
def test_the_run_is_in_the_mode_of_the_model_and_beside_it(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, kind: Recognizer, learns: bool
) -> None:
    """Takes of another mode would be other features; a run without three takes writes nothing."""
    ran: list[tuple[object, ...]] = []
    takes = [perform(NEW, n) for n in range(3)] if learns else []
    known = train({name: [perform(name, n) for n in range(3)] for name in KNOWN}, kind)
    monkeypatch.setattr(live_teaching, "model_to_teach", lambda *_: known)

    def live(settings: Settings, run: Path, _: Console, name: str, tell: Teaching) -> None:
        ran.append((settings.mode, run, name))
        if takes:
            tell.lesson = taught(known, NEW, takes, ["live"])

    monkeypatch.setattr(live_teaching, "live", live)
    out = tmp_path / "mine.npz"
    if learns:
        facts = teach_live(NEW, Settings(mode="paper"), out, plan, Console(quiet=True))
        assert [take["clip"] for take in facts["takes"]] == ["take 1", "take 2", "take 3"]
        assert facts["run"] == str(tmp_path / f"mine_{NEW}")
        assert load(out).names == (*KNOWN, NEW)
    else:
        with pytest.raises(TrainingError, match="ended before 3 takes"):
            teach_live(NEW, Settings(), out, plan, Console(quiet=True))
        assert not out.exists()
    assert ran == [(kind, tmp_path / f"mine_{NEW}", NEW)]


def test_a_posture_is_taught_again_where_that_is_asked_for(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    takes = [perform(NEW, n) for n in range(3)]

    def live(_: Settings, _run: Path, _console: Console, name: str, tell: Teaching) -> None:
        tell.lesson = taught(tell._known, name, takes, ["live"])

    monkeypatch.setattr(live_teaching, "live", live)
    out, quiet = tmp_path / "mine.npz", Console(quiet=True)
    assert not teach_live(NEW, Settings(), out, plan, quiet)["again"]
    mine = plan._replace(add_to=out)
    with pytest.raises(TrainingError, match="known already: --again"):
        teach_live(NEW, Settings(), out, mine, quiet)
    assert teach_live(NEW, Settings(), out, mine._replace(again=True), quiet)["again"]
    assert load(out).names == (*KNOWN, NEW)


@pytest.mark.slow
@pytest.mark.live
def test_a_recording_that_plays_as_live_teaches_a_posture(plan: Plan, tmp_path: Path) -> None:
    """Viewers, integrator and recogniser as processes; it is shown five times, with pauses."""
    rig, someone = default_rig(160, 120), person(5501)
    write_rig(tmp_path / "calibration.json", rig)
    shown = streamed(someone, 7, FPS, (NEW,) * 5)
    write_clip(tmp_path / "shown", someone, shown, Filming(rig, 1, 2), 1)
    settings = Settings(clip=str(tmp_path / "shown"), page=PageSettings(port=0))
    out = tmp_path / "mine.npz"
    facts = teach_live("both_up", settings, out, plan, Console(quiet=True), 0.0)
    assert len(facts["takes"]) == 3
    assert all(take["margin"] > 0.0 for take in facts["takes"])
    assert load(out).names == (*KNOWN, "both_up")


@pytest.mark.slow
@pytest.mark.live
def test_a_recording_in_which_nobody_shows_it_teaches_nothing(
    clip: Path, plan: Plan, tmp_path: Path
) -> None:
    settings = Settings(clip=str(clip), page=PageSettings(port=0))
    out = tmp_path / "mine.npz"
    with pytest.raises(TrainingError, match="ended before 3 takes of both_up agreed"):
        teach_live("both_up", settings, out, plan, Console(quiet=True), 0.0)
    assert not out.exists()
