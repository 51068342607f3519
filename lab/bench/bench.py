"""Benchmarks of this machine: a match, a search, a tracked clip, memory, loading."""

import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
import psutil
from rich.console import Console
from rich.table import Table

from common.config.part_settings import PageSettings, SearchSettings
from common.config.settings import Settings
from common.method import DEFAULT, METHODS, PAPER, Mode
from common.npz_file import Facts
from common.packages import ROOT
from common.source_digest import digest_of
from common.video.clips import open_clip
from integrator import integrator_warmup
from lab.bench.bench_figure import Measured, least_s
from lab.bench.bench_scenes import by_opencv, match_all, match_placed, model_pairs, scene
from lab.bench.single_bench import FOLLOWED, figures
from runtime.live.free_ports import free_settings
from runtime.live.session import live
from runtime.offline.lockstep import Decoders, track_clip
from runtime.store.runs import VERSIONS_OF, write_run
from synth.write import ClipSet, write_set
from viewer import track, viewer_warmup
from viewer.background.background import learn
from viewer.capture import recorded
from viewer.paper.arms import facade_arms, flank_arms
from viewer.paper.legs import facade_legs, flank_legs
from viewer.paper.posed_model import PosedModel
from viewer.paper.position import located
from viewer.room.background_source import opening_of_view
from viewer.silhouette import silhouette

SMALL, LARGE = (160, 120), (640, 480)
PERFORMER_SEED: Final = 90_002
"""Seed of a person outside the training data, which uses seeds below 1,000."""
FILMED: Final = (320, 240)


def bench(quick: bool = False) -> Facts:
    """Measure one item after the other: (machine, figures), ready for JSON.

    Times are the minimum of several repeats: other load on the machine only adds to them.

    Args:
        quick: Fewer repeats, and no live run.
    """
    return {
        "machine": machine(),
        "figures": [{**one._asdict(), "met": one.met} for one in measured(quick)],
    }


TRACKED: Final[tuple[tuple[Mode, str, float], ...]] = (
    ("paper", "160x120", 300.0),
    ("default", "160x120", 400.0),
    ("default", "320x240", 200.0),
)
"""Modes and sizes in which a clip is tracked, and the required frame pairs per second."""
REPEATS: Final = 5
"""Number of repeats per clip; the fastest counts."""


def measured(quick: bool) -> Iterator[Measured]:
    """All figures, each as soon as it is measured."""
    repeats = 3 if quick else 40
    yield from matching(SMALL, 0.2, repeats)
    yield from matching(LARGE, 0.5, repeats)
    yield from searching(SMALL, 2500.0, repeats)
    yield digesting(repeats)
    yield loading()
    with tempfile.TemporaryDirectory(prefix="tritrack-bench-") as folder:
        wanted = ClipSet("postures", seed=PERFORMER_SEED, postures=("walk_in_place",))
        clip = write_set(Path(folder), wanted, FILMED)[0]
        settings = Settings(clip=str(clip))
        for mode, size, due in TRACKED[:1] if quick else TRACKED:
            chosen = msgspec.structs.replace(settings, mode=mode, size=size)
            yield from tracking(chosen, Path(folder), 1 if quick else REPEATS, due)
        if not quick:
            for mode, size, due in FOLLOWED:
                chosen = msgspec.structs.replace(settings, mode=mode, size=size)
                yield from figures(chosen, REPEATS, due)
            yield from memory(settings, Path(folder))


def matching(size: tuple[int, int], target_us: float, repeats: int) -> Iterator[Measured]:
    """A limb match at one size: alone, with placing it in the picture, and with OpenCV."""
    at = f"{size[0]}x{size[1]}"
    given = scene(size)
    matches = given.primitives.shape[0] * given.primitives.shape[1]
    match_us = 1e6 * least_s(lambda: match_all(*given.matched), repeats) / matches
    placed_us = 1e6 * least_s(lambda: match_placed(*given.placed), repeats) / matches
    naive_us = 1e6 * least_s(by_opencv(given), repeats) / matches
    yield Measured(f"limb match, {at}", match_us, "us", target_us)
    yield Measured(f"limb match with its place, {at}", placed_us, "us")
    yield Measured(f"limb drawn by OpenCV, counted by numpy, {at}", naive_us, "us")
    yield Measured(f"ratio of the two, {at}", naive_us / match_us, "times")


def searching(size: tuple[int, int], target: float, repeats: int) -> Iterator[Measured]:
    """The paper's search from two silhouettes to all angles, on one core (sections 3.2 to 3.4)."""
    at = f"{size[0]}x{size[1]}"
    pairs, settings = model_pairs(size), SearchSettings()

    def both(facade: PosedModel, flank: PosedModel) -> int:
        one = facade_legs(facade_arms(located(facade), settings, False, PAPER), settings, False)
        arms = flank_arms(located(flank), settings, 0, False, PAPER)
        other = flank_legs(arms, settings, 0, PAPER)
        return one.matches + other.matches

    matches = sum(both(*pair) for pair in pairs) / len(pairs)
    pair_us = 1e6 * least_s(lambda: [both(*pair) for pair in pairs], repeats) / len(pairs)
    yield Measured(f"search of both views, {at}", 1e6 / pair_us, "frames/s", target)
    yield Measured(f"matches of both views, {at}", matches, "a frame")
    yield Measured(f"search for each match, {at}", pair_us / matches, "us")


def digesting(repeats: int) -> Measured:
    """Time for a process to check that its compiled code belongs to its sources."""
    return Measured(
        "digest of the sources", 1e3 * least_s(lambda: digest_of(ROOT), repeats), "ms", 20.0
    )


def loading() -> Measured:
    """Time for a new process to load its compiled code, without imports."""
    loaded_s()
    code = "from lab.bench.bench import loaded_s; print(loaded_s())"
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return Measured("loading of compiled functions", float(told.stdout), "s", 1.0)


def loaded_s() -> float:
    """Compile or load all code of a viewer and the integrator; returns the seconds taken."""
    began = time.perf_counter()
    settings = Settings()
    background = learn([np.full((SMALL[1], SMALL[0], 3), 128, np.uint8)])
    for viewer in integrator_warmup.VIEWERS:
        viewer_warmup.warm_up(
            track.init(track.Setup(viewer, None, settings, DEFAULT), background), SMALL
        )
    integrator_warmup.warm_up(settings, SMALL)
    return time.perf_counter() - began


def tracking(settings: Settings, folder: Path, repeats: int, target: float) -> Iterator[Measured]:
    """A clip of two videos tracked to its poses.npz, in one process, with the time of each
    stage."""
    seconds: dict[str, float] = {}
    frames = 0
    with Decoders() as decoders:
        track_clip(settings, decoders)
        for _ in range(repeats):
            began = time.perf_counter()
            tracked = track_clip(settings, decoders)
            write_run(folder / "run", tracked.bodies, settings, tracked.facts)
            frames = len(tracked.bodies)
            now = {**tracked.facts["seconds"], "all": time.perf_counter() - began}
            seconds = {name: min(value, seconds.get(name, value)) for name, value in now.items()}
        silhouettes_s = min(_silhouettes_s(settings, decoders) for _ in range(repeats))
    at = f"{settings.mode}, {settings.size}"
    yield Measured(f"track, video to poses, {at}", frames / seconds["all"], "frames/s", target)
    for what, value_s in {
        "preparation": seconds["preparation"],
        "silhouettes": silhouettes_s,
        "viewers, silhouettes included": seconds["viewers"],
        "integrator": seconds["integrator"],
    }.items():
        yield Measured(f"- {what}, {at}", 1e3 * value_s / frames, "ms a frame")


def _silhouettes_s(settings: Settings, decoders: Decoders) -> float:
    """Seconds for the silhouettes of both views of a clip."""
    total_s = 0.0
    for view in open_clip(settings, decoders.of[1]).views:
        decoder = decoders.of[view.number]
        background = opening_of_view(view, settings.silhouette, decoder).background
        state = silhouette.init(background, settings.silhouette, METHODS[settings.mode])
        for frame in recorded(view, 1, decoder):
            began = time.perf_counter()
            state, _ = silhouette.step(state, frame.picture, None)
            total_s += time.perf_counter() - began
    return total_s


def memory(settings: Settings, folder: Path) -> Iterator[Measured]:
    """Resident memory of each process of a live run, without the page's browser."""
    settings = free_settings(msgspec.structs.replace(settings, page=PageSettings(port=0)))
    facts = live(settings, folder / "live", Console(quiet=True))
    for name, told in facts["processes"].items():
        yield Measured(f"memory of {name}", told["memory_mb"], "MB")


def machine() -> Facts:
    """The machine and the date."""
    try:
        told = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(line.partition(":")[2].strip() for line in told if "model name" in line)
    except (OSError, StopIteration):
        model = platform.processor() or platform.machine()
    return {
        "cpu": model,
        "cores": os.cpu_count(),
        "load_average": [round(load, 2) for load in psutil.getloadavg()],
        "python": platform.python_version(),
        "versions": {name: version(name) for name in VERSIONS_OF},
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def table_of(result: Facts) -> Table:
    """The figures as a table."""
    facts = result["machine"]
    title = f"{facts['cpu']}, {facts['cores']} cores, load {facts['load_average'][0]}"
    table = Table("what", "measured", "unit", "target", title=title, title_justify="left")
    colours = {None: "", True: "[green]", False: "[red]"}
    for one in result["figures"]:
        target = "" if one["target"] is None else f"{colours[one['met']]}{one['target']:g}"
        table.add_row(one["what"], f"{one['value']:.4g}", one["unit"], target)
    return table


def main(json_wanted: bool, quick: bool) -> None:
    """Measure and print."""
    result = bench(quick)
    if json_wanted:
        print(json.dumps(result, indent=1))
    else:
        Console().print(table_of(result))
