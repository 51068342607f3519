"""How far standing feet slide in what users take away, and what holding them costs.

`python benchmarks/foot_slide.py RUNS CLIPS/*/`: runs of `tritrack track CLIPS/*/ --out RUNS`, and
clips with a truth that has toes. A contact is where the true ankle and the true toe are low and
slow; its slide is how far the ankle comes from where it mostly is, over the floor.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.bvh import steady
from animator.skeleton.bones import joints_of
from animator.skeleton.foot_contact import SIDES, stances
from animator.skeleton.planted_feet import planted
from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES
from runtime.store.joint_arrays import all_joints_m
from runtime.store.past_run import open_run

Floats = NDArray[np.float64]

SLOW_M_S, LOW_M = 0.15, 0.02
"""A true foot stands below this speed, not higher above its lowest place."""
LEAST: Final = 3
"""Frames of a contact."""
KINDS: Final = ("poses.npz", "trc, c3d", "bvh, gltf, mot")


class Clip(NamedTuple):
    """One clip: the truth of each row, and the same body as each kind of file has it."""

    true_m: Floats
    """(n, joints, 3), NaN where nobody is."""
    names: list[str]
    time_s: Floats
    made_m: dict[str, Floats]
    """(n, 22, 3) by KINDS."""


def clip_of(run: Path, clip: Path) -> Clip:
    """A run and its truth."""
    poses = open_run(run).poses
    with np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        true_m = truth["joints3d"][truth["frames_cam1"][poses["frame"]]].astype(float)
    joints_m, time_s = all_joints_m(poses), poses["time_s"]
    skeleton, motion, steps = steady(joints_m, time_s)
    bones_m = np.full_like(joints_m, np.nan)
    bones_m[steps.posed] = joints_of(skeleton, motion)[np.rint(steps.places).astype(int)]
    files = (joints_m, planted(joints_m, time_s).joints_m, bones_m)
    return Clip(true_m, names, time_s, dict(zip(KINDS, files, strict=True)))


def true_stands(clip: Clip, side: str) -> NDArray[np.bool_]:
    """(n,) where a true foot stands."""
    stands = np.ones(len(clip.true_m), np.bool_)
    for part in ("ankle", "toe"):
        place = clip.true_m[:, clip.names.index(f"{side}_{part}")]
        steps = np.linalg.norm(np.diff(place, axis=0), axis=1) / np.diff(clip.time_s)
        speeds = np.fmax(np.append(steps, np.nan), np.append(np.nan, steps))
        with np.errstate(invalid="ignore"):
            stands &= (speeds < SLOW_M_S) & (place[:, 1] < np.nanmin(place[:, 1]) + LOW_M)
    return stands


def stretches(flags: NDArray[np.bool_]) -> Iterator[slice]:
    """Where flags stay up for LEAST rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        if end - first >= LEAST:
            yield slice(int(first), int(end))


def slide_mm(place_m: Floats) -> float:
    """How far a foot comes from where it mostly is, over the floor."""
    return 1e3 * float(
        np.linalg.norm((place_m - np.median(place_m, axis=0))[:, [0, 2]], axis=1).max()
    )


def measured(clips: list[Clip]) -> None:
    """Print slides, errors and residuals of these clips."""
    slides: dict[str, list[float]] = {kind: [] for kind in ("truth", *KINDS)}
    counts = np.zeros(3)
    for clip in clips:
        found = stances(clip.made_m[KINDS[0]], clip.time_s)
        for side in SIDES:
            stands, at = true_stands(clip, side), JOINT_NAMES.index(f"{side}_ankle")
            told = np.zeros_like(stands)
            for each in found:
                told[each.first : each.end] |= each.side == side
            counts += [(told & stands).sum(), (told & ~stands).sum(), (~told & stands).sum()]
            for part in stretches(stands & np.isfinite(clip.made_m[KINDS[0]][:, at, 0])):
                slides["truth"].append(
                    slide_mm(clip.true_m[part, clip.names.index(f"{side}_ankle")])
                )
                for kind in KINDS:
                    slides[kind].append(slide_mm(clip.made_m[kind][part, at]))
    both, more, less = counts
    print(
        f"{len(slides['truth'])} contacts; rows told to stand {both / (both + more):.1%} right, "
        f"{both / (both + less):.1%} of those that do"
    )
    for kind, values in slides.items():
        shown = ", ".join(f"{value:.1f}" for value in np.percentile(values, [50, 75, 90]))
        print(f"slide a contact, {kind}: median, 75 %, 90 % {shown} mm")
    for kind in KINDS:
        told_off = "; ".join(
            f"{name} {value:.1f}" for name, value in errors_mm(clips, kind).items()
        )
        print(f"mean off the truth, {kind}: {told_off} mm")
    for kind in KINDS[1:]:
        off = np.concatenate([_off(clip, kind, KINDS[0]) for clip in clips])
        middle, worst = np.percentile(off, [50, 95])
        print(f"{kind} off poses.npz: median {middle:.1f}, 95 % {worst:.1f} mm")


def errors_mm(clips: list[Clip], kind: str) -> dict[str, float]:
    """Mean distance of joints from the truth, both sides together."""
    told: dict[str, float] = {}
    for part in ("hip", "knee", "ankle", "toe", "knuckle"):
        off: list[Any] = []
        for clip in clips:
            for side in SIDES:
                name = f"{side}_{part}"
                true_m = clip.true_m[:, clip.names.index(name)]
                made_m = clip.made_m[kind][:, ALL_JOINT_NAMES.index(name)]
                off.append(1e3 * np.linalg.norm(made_m - true_m, axis=1))
        told[part] = float(np.nanmean(np.concatenate(off)))
    return told


def _off(clip: Clip, kind: str, other: str) -> Floats:
    joints = slice(len(JOINT_NAMES))
    off = 1e3 * np.linalg.norm(clip.made_m[kind][:, joints] - clip.made_m[other][:, joints], axis=2)
    return np.asarray(off[np.isfinite(off)])


def main() -> None:
    """Read the command line and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("clips", type=Path, nargs="+")
    given = parser.parse_args()
    measured([clip_of(given.runs / clip.name, clip) for clip in given.clips])


if __name__ == "__main__":
    main()
