"""What the tests share: where the clips lie."""

import os
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from hypothesis import settings
from waiting import until

if TYPE_CHECKING:
    from runtime.offline.lockstep import Tracked

# As in the product's own processes: tests run side by side.
for library in ("OMP", "OPENBLAS", "NUMBA"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

# Containers ask for none. Each process of pytest would rewrite all tests anew: 13 s of each.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

MARKS: Final = ("slow", "live")
LONGEST: Final = (
    *("readme", "system_wheel", "system_namespaces", "system_live_fallback", "system_commands"),
    *("lockstep", "proposal_training", "demo", "resuming", "performance", "serve", "tracker"),
    *("start", "video_training", "board_rig", "compiled", "launch", "person_calibration"),
    *("live", "marking"),
)
"""Files that take minutes: begun first, so that none is left alone at the end."""

MADE_S: Final = 900.0
"""Patience with another process that makes what all need: it may have to compile."""


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """A file without a mark that is asked for is not imported: most have no slow test.

    Nor is one that is slow as a whole where slow ones are left out: those import torch, 7 s.
    """
    asked: str = config.option.markexpr
    parts = [] if " or " in asked else asked.split(" and ")
    marks = [each for each in parts if each in MARKS]
    left_out = [mark for mark in MARKS if f"not {mark}" in parts]
    if not (marks or left_out) or collection_path.suffix != ".py":
        return None
    text = collection_path.read_text()
    lacks = any(f"mark.{mark}" not in text for mark in marks)
    return lacks or any(f"\npytestmark = pytest.mark.{mark}\n" in text for mark in left_out) or None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Where files are handed out in their order (`--no-loadscope-reorder`): the longest first."""
    refuse_marks_of_elsewhere(items)
    place = {f"test_{name}": at for at, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path.stem, len(LONGEST)))


def refuse_marks_of_elsewhere(items: list[pytest.Item]) -> None:
    """A mark stands in the file of its test, where `pytest_ignore_collect` looks for it."""
    missing = {
        path: [mark for mark in MARKS if f"mark.{mark}" not in path.read_text()]
        for path in {item.path for item in items}
    }
    for item in items:
        if any(item.get_closest_marker(mark) for mark in missing[item.path]):
            raise pytest.UsageError(f"{item.nodeid}: write its mark into its file")


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of development clips, or a skip that says how to name it."""
    default = Path(__file__).parents[2] / "shared" / "data"
    folder = Path(os.environ.get("TRITRACK_DATA", default))
    if not folder.is_dir():
        pytest.skip("no development clips: set TRITRACK_DATA to their folder")
    return folder


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder that one of the processes of tests makes for all; who changes it copies it before.

    Args:
        factory: Of this process; the folder lies beside what each has of its own.
        name: The folder's name.
        make: Fills it. Where that fails, the others go on too and see what there is.
    """
    own = factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / name
    done = folder.with_name(f"{name} is made")
    try:
        folder.mkdir()
    except FileExistsError:
        assert until(done.exists, MADE_S), f"{folder} was not made in time"
        return folder
    try:
        make(folder)
    finally:
        done.touch()
    return folder


@pytest.fixture(scope="session")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A made-up clip with truth: a person of no training set raises the right arm."""
    from synth.write import ClipSet, write_set

    wanted = ClipSet("postures", seed=90_001, postures=("raise_right_lateral",))
    folder = made_once(tmp_path_factory, "clips", lambda out: write_set(out, wanted, (160, 120)))
    return next(folder.glob("*/meta.json")).parent


@pytest.fixture(scope="session")
def three_views(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A clip of three cameras: somebody squats."""
    from synth.write import ClipSet, write_set

    wanted = ClipSet("postures", seed=61_001, postures=("squat",), cameras=3)
    folder = made_once(tmp_path_factory, "three", lambda out: write_set(out, wanted, (160, 120)))
    return next(folder.glob("*/meta.json")).parent


@pytest.fixture(scope="session")
def recorded_run(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of what is made of that clip by default, by both views, with its recording."""

    def record(out: Path) -> None:
        from rich.console import Console

        from runtime.offline.batch import Asked, track_all
        from runtime.offline.lockstep import track_clip

        def kept(*given: Any, **named: Any) -> "Tracked":
            tracked = track_clip(*given, **named)
            whole = tracked._replace(bodies=[*tracked.bodies])
            (out / "tracked").write_bytes(pickle.dumps(whole))
            return tracked

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("runtime.offline.batch.track_clip", kept)
            track_all([clip], out, Asked(record=True), Console(quiet=True))

    return made_once(tmp_path_factory, "recorded", record) / clip.name


@pytest.fixture(scope="session")
def tracked_clip(recorded_run: Path) -> "Tracked":
    """The same, before it was written."""
    tracked: Tracked = pickle.loads((recorded_run.parent / "tracked").read_bytes())
    return tracked


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bus's keys, for two days."""
    from runtime.keys.authority import make_keys

    folder = tmp_path_factory.mktemp("keys")
    make_keys(folder, [], 2)
    return folder
