"""The rig of a live run without a calibration: what is told of it, with a solver that is none."""

from pathlib import Path

import msgspec
import pytest
from joined_clips import joined
from rich.console import Console
from staging import PERIOD_S, RIG
from test_rig_search import GOOD, both

from calibration.gate import rig_agreement
from common.bus.instant import Instant
from common.bus.messages import Agreement
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.method import METHODS
from common.rig.camera import Rig
from common.rig.upright import Shift
from common.video.clip_facts import Clip, ClipView, Meta
from integrator import merge, merge_state
from integrator.live_rig import live_calibration
from integrator.live_rig.live_calibration import LiveCalibration, is_by_person
from integrator.live_rig.rig_job import Job, Solution, Trusted, Unsolved
from integrator.live_rig.rig_search import ASKS_S
from integrator.merge_state import Start, State
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from tritrack.replaying import replay_run


class Solver:
    """Answers each job with the same, once it is let."""

    def __init__(self) -> None:
        self.jobs: list[Job] = []
        self.said: Solution | None = None

    def ask(self, job: Job) -> None:
        self.jobs.append(job)

    def answer(self) -> Solution | None:
        said, self.said = self.said, None
        return said

    def close(self) -> None:
        """It has no process."""


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> Solver:
    one = Solver()
    monkeypatch.setattr(live_calibration, "RigSolver", lambda: one)
    return one


def begun() -> State:
    settings = Settings()
    return merge_state.init(None, PERIOD_S, settings, METHODS[settings.mode], Start(by_person=True))


def test_the_network_proposes_from_the_first_frame_where_the_person_will_tell_the_rig() -> None:
    assert begun().proposes
    assert begun().scale_source == "assumed"


def test_a_rig_that_is_taken_is_told_with_its_moment_and_the_frames_wait_for_nothing(
    solver: Solver,
) -> None:
    state = begun()
    with LiveCalibration(state, looks=True) as calibration:
        for n in range(round(2 * ASKS_S[0] / PERIOD_S)):
            calibration.heard(Instant(both(n)))
            assert calibration.changed(state) is state
        assert len(solver.jobs) == 1
        solver.said = GOOD
        state = calibration.changed(state)
    assert (state.rig, state.scale_source, state.calibration) == (RIG, "person", 1)
    (told,) = calibration.news
    assert told.startswith("7.9 s: the cameras are now calibrated by the person: views 11 mm apart")


@pytest.mark.parametrize(
    ("said", "why"),
    [
        (Unsolved("nobody there"), "the person tells none (nobody there)"),
        (None, "was not found in time"),
    ],
)
def test_a_run_whose_person_told_no_rig_says_at_its_end_why(
    solver: Solver, said: Solution | None, why: str
) -> None:
    state = begun()
    with LiveCalibration(state, looks=True) as calibration:
        for n in range(round(1.5 * ASKS_S[0] / PERIOD_S)):
            calibration.heard(Instant(both(n)))
        solver.said = said
        assert calibration.changed(state) is state
    assert why in calibration.news[-1]


@pytest.mark.parametrize(
    ("rig", "views", "settings", "looks"),
    [
        (None, 2, Settings(), True),
        (RIG, 2, Settings(), False),
        (None, 1, Settings(), False),
        (None, 2, Settings(mode="paper"), False),
        (None, 2, Settings(landmarks="none"), False),
    ],
    ids=["two views", "calibrated", "one view", "paper", "no landmarks"],
)
def test_only_two_views_with_landmarks_and_no_calibration_are_calibrated_by_the_person(
    rig: Rig | None, views: int, settings: Settings, looks: bool
) -> None:
    view = ClipView(1, "cam1.avi", (320, 240), (160, 120), 15.0, 10)
    assert is_by_person(Clip("walk", (view,) * views, 1, rig, Meta()), settings) == looks


@pytest.mark.slow
@pytest.mark.live
def test_a_live_run_is_calibrated_by_its_person_and_is_replayed_byte_for_byte(
    data_dir: Path, tmp_path: Path
) -> None:
    """Twenty seconds of walking: a quiet machine needs nine of them."""
    pytest.importorskip("mcap", reason="pip install 'tritrack[mcap]'")
    joined(tmp_path / "clip", sorted((data_dir / "dev").glob("r01_*"))[:5])
    settings = free_settings(Settings(clip=str(tmp_path / "clip"), page=PageSettings(port=0)))
    told = live(settings, tmp_path / "run", Console(quiet=True), record=True)
    assert told["scale_source"] == "person"
    assert len(told["calibration"]["cameras"]) == 2
    assert any("now calibrated by the person" in line for line in told["warnings"])
    facts = replay_run(tmp_path / "run", None)
    assert facts["same"] == facts["bodies"] > 250


def told_of(n: int, shift: Shift | None) -> Instant:
    first, second = both(n)
    assert second is not None
    return Instant((first, msgspec.structs.replace(second, shift=shift)))


def test_a_camera_that_is_moved_is_turned_at_once_and_then_placed_by_the_person(
    solver: Solver,
) -> None:
    settings = Settings()
    state = merge_state.init(RIG, PERIOD_S, settings, METHODS[settings.mode])
    shift = Shift(10.0, 0.0, 0.0)
    with LiveCalibration(state, looks=False) as calibration:
        for n in range(60):
            pair = told_of(n, None if n < 45 else shift)
            state, _, _ = merge.step(state, pair)
            calibration.heard(pair)
            state = calibration.changed(state)
        assert not solver.jobs
        assert (state.calibration, state.scale_source) == (1, "calibrated")
        assert state.stands.doubtful == (2,)
        assert state.rig is not None
        assert state.rig.cameras[0] == RIG.cameras[0]
        for n in range(60, 60 + round(2 * ASKS_S[0] / PERIOD_S)):
            calibration.heard(told_of(n, shift))
        (job,) = solver.jobs
        assert (job.moved, job.rig) == ((2,), state.rig)
        assert job.stood is not None
        assert job.stood.rig == RIG
        second = msgspec.structs.replace(state.rig.cameras[1], t=(0.0, 1.0, 4.1))
        placed = msgspec.structs.replace(RIG, cameras=(RIG.cameras[0], second))
        solver.said = msgspec.structs.replace(GOOD, rig=placed, before=Trusted(12.0, ()))
        state = calibration.changed(state)
    assert (state.rig, state.scale_source, state.stands.doubtful) == (placed, "calibrated", ())
    assert [line.split(": ", 1)[1].split(",")[0] for line in calibration.news] == [
        "camera 2 was moved",
        "camera 2 was placed anew by the person: views 11 mm apart",
    ]


def test_who_trusts_the_calibration_keeps_it_where_a_camera_is_moved(solver: Solver) -> None:
    settings = Settings(trust_calibration=True)
    state = merge_state.init(RIG, PERIOD_S, settings, METHODS[settings.mode])
    with LiveCalibration(state, looks=False) as calibration:
        pair = told_of(0, Shift(10.0, 0.0, 0.0))
        state, body, _ = merge.step(state, pair)
        calibration.heard(pair)
        assert calibration.changed(state) is state
    assert body.moved == (2,)
    assert not calibration.news


def doubted(state: State) -> State:
    """Both views place joints 90 mm apart by a calibrated rig."""
    told = Agreement(90.0, 3.0, 4.0, 5.0, 0.05)
    return state._replace(
        rig=RIG, scale_source="calibrated", agreement=rig_agreement.State(told=told)
    )


def test_a_rig_that_is_doubted_is_looked_for_once_and_its_end_says_which_stayed(
    solver: Solver,
) -> None:
    state = doubted(begun())
    with LiveCalibration(state, looks=False, late_s=0.25) as calibration:
        calibration.heard(Instant(both(0)))
        assert not calibration.looking.search.rows[0], "nothing is looked for yet"
        assert calibration.changed(state) is state
        assert calibration.looking.looks
        assert calibration.looking.search.rig == RIG
        assert calibration.looking.search.late_s == calibration.late_s == 0.25
        calibration.heard(Instant(both(1)))
        begun_once = calibration.looking.search
        assert begun_once.rows[0]
        calibration.changed(state)
        assert calibration.looking.search is begun_once, "the same rig is not doubted twice"
        assert calibration.looking.doubted == 0
        again = state._replace(calibration=1)
        calibration.changed(again)
        assert calibration.looking.search is begun_once, "it is looked for already"
        assert calibration.looking.doubted == 1
    assert calibration.news == (
        "0.1 s: the rig that is not believable stayed: both cameras saw somebody move for 0 s, "
        "of 4 needed",
    )


def test_a_rig_that_nobody_doubts_is_let_be_and_nothing_is_said_at_the_end(solver: Solver) -> None:
    state = begun()._replace(rig=RIG, scale_source="calibrated")
    closed: list[bool] = []
    solver.close = lambda: closed.append(True)  # type: ignore[method-assign]
    with LiveCalibration(state, looks=False) as calibration:
        for n in range(5):
            calibration.heard(Instant(both(n)))
            assert calibration.changed(state) is state
    assert closed == [True]
    assert calibration.news == ()
    assert not calibration.looking.looks
    assert calibration.looking.now_s == pytest.approx(4 / 15)
    assert len(calibration.looking.lately.rows) == 5


def test_a_late_view_is_set_back_when_the_rig_that_says_so_is_taken(solver: Solver) -> None:
    state = begun()
    with LiveCalibration(state, looks=True) as calibration:
        for n in range(round(1.1 * ASKS_S[0] / PERIOD_S)):
            calibration.heard(Instant(both(n)))
        solver.said = msgspec.structs.replace(GOOD, late_s=0.2)
        assert calibration.changed(state).rig == RIG
        assert calibration.late_s == 0.2
        assert calibration.looking.stays == ""
    assert len(calibration.news) == 1
    assert "camera 2 +200 ms late" in calibration.news[0]
