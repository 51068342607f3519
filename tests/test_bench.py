"""The benchmark: it measures what it says, and says all of it; how fast is not tested."""

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from common.body.body import POSE_INDEX, rest_pose
from common.config.settings import Settings
from common.raster.bits import unpack_words
from common.raster.row_spans import gain, spans
from lab.bench import bench as module
from lab.bench.bench import bench, machine, table_of
from lab.bench.bench_figure import Measured
from lab.bench.bench_scenes import by_opencv, match_placed, scene, swayed

SIZES = [(160, 120), (640, 480)]


@pytest.fixture(scope="module")
def result() -> dict[str, Any]:
    return bench(quick=True)


@pytest.mark.slow
def test_every_figure_is_finite_and_positive(result: dict[str, Any]) -> None:
    for one in result["figures"]:
        assert math.isfinite(one["value"])
        assert one["value"] > 0, one["what"]


@pytest.mark.slow
def test_what_the_design_asks_for_is_measured_against_it(result: dict[str, Any]) -> None:
    """Design, section 4: 0.2 us a match; the search 2,500 and tracking 300 frame pairs a second."""
    targets = {one["what"]: one["target"] for one in result["figures"] if one["target"]}
    assert targets == {
        "limb match, 160x120": 0.2,
        "limb match, 640x480": 0.5,
        "search of both views, 160x120": 2500.0,
        "digest of the sources": 20.0,
        "loading of compiled functions": 1.0,
        "track, video to poses, paper, 160x120": 300.0,
    }


@pytest.mark.slow
def test_the_result_is_json_and_a_table(result: dict[str, Any]) -> None:
    assert json.loads(json.dumps(result)) == result
    assert table_of(result).row_count == len(result["figures"])


def test_the_machine_is_named() -> None:
    facts = machine()
    assert facts["cpu"]
    assert facts["cores"] >= 1
    assert {"numpy", "numba"} <= facts["versions"].keys()


def test_a_rate_is_to_be_reached_and_a_time_not_to_be_exceeded() -> None:
    assert Measured("search", 2600.0, "frames/s", 2500.0).met
    assert not Measured("search", 2400.0, "frames/s", 2500.0).met
    assert Measured("match", 0.1, "us", 0.2).met
    assert not Measured("match", 0.3, "us", 0.2).met
    assert Measured("memory", 200.0, "MB").met is None


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_matches_are_of_limbs_in_the_picture_that_show_beside_the_rest(
    size: tuple[int, int],
) -> None:
    """A match of an empty or hidden limb would cost nothing."""
    given = scene(size)
    first, last = np.empty(size[1], np.int32), np.empty(size[1], np.int32)
    for rest, row in zip(given.rests, given.primitives, strict=True):
        shown = []
        for outline in row:
            top, bottom = spans(outline, size[0], size[1], first, last)
            assert bottom - top > 0.05 * size[1]
            shown.append(gain(first, last, top, bottom, rest, given.seen)[0])
        assert max(shown) > 0.001 * size[0] * size[1]


def test_opencv_is_given_the_same_limbs() -> None:
    """Drawing a limb adds what is new of it to overlap and union together: nearly as much."""
    size = (640, 480)
    given = scene(size)
    seen = unpack_words(given.seen, size[0])
    first, last = np.empty(size[1], np.int32), np.empty(size[1], np.int32)
    new = before = 0
    for rest, row in zip(given.rests, given.primitives, strict=True):
        drawn = unpack_words(rest, size[0])
        before += len(row) * (int((drawn & seen).sum()) + int((drawn | seen).sum()))
        for outline in row:
            rows = spans(outline, size[0], size[1], first, last)
            new += gain(first, last, *rows, rest, given.seen)[0]
    assert by_opencv(given)() - before == pytest.approx(new, rel=0.1)


def test_placed_matches_are_the_same_matches() -> None:
    """From angles to scores: every one of the scores is a similarity."""
    given = scene((160, 120))
    total = match_placed(*given.placed)
    assert 0.0 < total < given.poses.shape[0] * given.poses.shape[1]


def counted(monkeypatch: pytest.MonkeyPatch, *seconds: float) -> list[int]:
    """Work takes these seconds, one after the other; how often it would be repeated."""
    repeats, left = list[int](), list(seconds)

    def least(work: Any, times: int) -> float:
        repeats.append(times)
        return left.pop(0)

    monkeypatch.setattr(module, "least_s", least)
    return repeats


def test_a_match_is_timed_alone_placed_and_as_opencv_would(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 8 limbs in 9 poses: 72 matches in 72, 144 and 720 microseconds."""
    repeats = counted(monkeypatch, 72e-6, 144e-6, 720e-6)
    found = list(module.matching((160, 120), 0.2, 7))
    assert repeats == [7, 7, 7]
    assert [one.what for one in found] == [
        "limb match, 160x120",
        "limb match with its place, 160x120",
        "limb drawn by OpenCV, counted by numpy, 160x120",
        "ratio of the two, 160x120",
    ]
    assert [one.value for one in found] == pytest.approx([1.0, 2.0, 10.0, 10.0])
    assert [(one.unit, one.target) for one in found] == [
        ("us", 0.2),
        ("us", None),
        ("us", None),
        ("times", None),
    ]


def test_a_search_is_timed_for_a_frame_and_for_each_of_its_matches(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the 12 pairs of views in 6 milliseconds: 2000 frames a second, half a millisecond each."""
    repeats = counted(monkeypatch, 6e-3)
    rate, matches, each = module.searching((160, 120), 2500.0, 3)
    assert repeats == [3]
    assert rate.value == pytest.approx(2000.0)
    assert rate[2:] == ("frames/s", 2500.0)
    assert matches.unit == "a frame"
    assert 20 < matches.value < 400
    assert each.value == pytest.approx(500.0 / matches.value)


def test_what_is_loaded_and_digested_has_its_units(monkeypatch: pytest.MonkeyPatch) -> None:
    counted(monkeypatch, 0.004)
    digest: Any = module.digesting(2)
    assert digest == ("digest of the sources", pytest.approx(4.0), "ms", 20.0)
    asked: list[Any] = []

    def run(words: list[str], **_: Any) -> Any:
        asked.append(words)
        return SimpleNamespace(stdout="0.75\n")

    monkeypatch.setattr(module, "loaded_s", lambda: asked.append("compiled first"))
    monkeypatch.setattr("subprocess.run", run)
    assert module.loading() == ("loading of compiled functions", 0.75, "s", 1.0)
    assert asked[0] == "compiled first"
    assert "print(loaded_s())" in asked[1][2]


def tracked(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """A clip of 40 frames is tracked in ever other times, by a clock that moves as it is said."""
    noted: list[Any] = []
    now, took = [0.0], iter((9.0, 0.5, 0.25, 0.75))
    parts = iter(
        {"preparation": p, "viewers": v, "integrator": i}
        for p, v, i in ((9, 9, 9), (0.08, 0.2, 0.04), (0.12, 0.1, 0.02), (0.04, 0.3, 0.06))
    )

    def track(settings: Any, _: Any) -> Any:
        now[0] += next(took)
        return SimpleNamespace(bodies=[None] * 40, facts={"seconds": next(parts)})

    silhouettes = iter((0.2, 0.12, 0.3))
    monkeypatch.setattr(module, "track_clip", track)
    monkeypatch.setattr(module, "write_run", lambda folder, *_: noted.append(folder))
    monkeypatch.setattr(module, "_silhouettes_s", lambda *_: next(silhouettes))
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    return noted


def test_the_fastest_of_each_part_counts_and_the_first_run_does_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted = tracked(monkeypatch)
    settings = Settings(clip="c", mode="paper", size="160x120")
    rate, *parts = module.tracking(settings, tmp_path, 3, 300.0)
    assert rate.what == "track, video to poses, paper, 160x120"
    assert rate.value == pytest.approx(40 / 0.25)
    assert rate[2:] == ("frames/s", 300.0)
    assert {part.what: part.value for part in parts} == {
        "- preparation, paper, 160x120": pytest.approx(1.0),
        "- silhouettes, paper, 160x120": pytest.approx(3.0),
        "- viewers, silhouettes included, paper, 160x120": pytest.approx(2.5),
        "- integrator, paper, 160x120": pytest.approx(0.5),
    }
    assert {part.unit for part in parts} == {"ms a frame"}
    assert noted == [tmp_path / "run"] * 3


def test_each_process_of_a_live_run_has_its_memory(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[Any] = []

    def live(settings: Settings, folder: Path, console: Any) -> Any:
        asked.append((settings.page.port, folder, console.quiet))
        return {"processes": {"viewer1": {"memory_mb": 120.0}, "integrator": {"memory_mb": 90.0}}}

    monkeypatch.setattr(module, "free_settings", lambda settings: settings)
    monkeypatch.setattr(module, "live", live)
    assert list(module.memory(Settings(), tmp_path)) == [
        ("memory of viewer1", 120.0, "MB", None),
        ("memory of integrator", 90.0, "MB", None),
    ]
    assert asked == [(0, tmp_path / "live", True)]


@pytest.mark.parametrize("quick", [True, False])
def test_a_whole_benchmark_measures_in_order_and_a_quick_one_less(
    monkeypatch: pytest.MonkeyPatch, quick: bool
) -> None:
    noted: list[Any] = []

    def note(name: str, many: bool = True) -> Any:
        def noted_by(*given: Any) -> Any:
            told = [f"{one.mode} {one.size}" if isinstance(one, Settings) else one for one in given]
            noted.append((name, *(one for one in told if not isinstance(one, Path))))
            return iter(()) if many else name

        return noted_by

    for name in ("matching", "searching", "tracking", "figures", "memory"):
        monkeypatch.setattr(module, name, note(name))
    for name in ("digesting", "loading"):
        monkeypatch.setattr(module, name, note(name, many=False))
    monkeypatch.setattr(module, "write_set", lambda folder, wanted, size: [folder / "clip"])
    found: list[Any] = list(module.measured(quick))
    assert found == ["digesting", "loading"]
    repeats = 3 if quick else 40
    due = [
        ("matching", (160, 120), 0.2, repeats),
        ("matching", (640, 480), 0.5, repeats),
        ("searching", (160, 120), 2500.0, repeats),
        ("digesting", repeats),
        ("loading",),
        ("tracking", "paper 160x120", 1 if quick else 5, 300.0),
    ]
    if not quick:
        due += [
            ("tracking", "default 160x120", 5, 400.0),
            ("tracking", "default 320x240", 5, 200.0),
            ("figures", "default 320x240", 5, 200.0),
            ("figures", "thesis 320x240", 5, 200.0),
            ("memory", f"{Settings().mode} {Settings().size}"),
        ]
    assert noted == due


def test_the_table_shows_four_digits_and_colours_what_is_asked_for() -> None:
    facts = {"cpu": "a chip", "cores": 4, "load_average": [0.25, 0.5, 1.0]}
    figures = [
        {"what": "one", "value": 1234.567, "unit": "us", "target": None, "met": None},
        {"what": "two", "value": 0.0123456, "unit": "s", "target": 0.02, "met": True},
        {"what": "three", "value": 3.0, "unit": "s", "target": 2.5, "met": False},
    ]
    table = table_of({"machine": facts, "figures": figures})
    assert table.title == "a chip, 4 cores, load 0.25"
    columns = [list(column.cells) for column in table.columns]
    assert columns == [
        ["one", "two", "three"],
        ["1235", "0.01235", "3"],
        ["us", "s", "s"],
        ["", "[green]0.02", "[red]2.5"],
    ]


def test_limbs_sway_and_the_trunk_does_not() -> None:
    """A walking person's angles: 12 degrees of standard deviation, from the shoulders on."""
    rng = np.random.default_rng(5)
    changed = np.array([swayed(rest_pose(), rng) for _ in range(400)]) - rest_pose()
    begin = POSE_INDEX["r_shoulder_x"]
    assert (changed[:, :begin] == 0).all()
    assert changed[:, begin:].std() == pytest.approx(12.0, rel=0.05)
    assert abs(changed[:, begin:].mean()) < 0.6
