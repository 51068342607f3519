"""What a report says of a run in words: its size, its cameras, its clocks."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from common.npz_file import Facts
from runtime.offline.rig_check import clock_words
from runtime.store.past_run import PastRun
from runtime.store.run_people import people_of
from runtime.terminal import counted

SCALES = {
    "calibrated": "by the calibration",
    "person": "by the person's motion",
    "assumed": "assumed: lengths and places are guesses",
}
"""Source of a rig, in words."""


def facts_of(run: PastRun) -> list[tuple[str, str]]:
    """Names and values for the page's head."""
    summary, time_s = run.summary, np.asarray(run.poses["time_s"], float)
    names = [str(name) for name in run.poses["camera_names"]]
    used = np.any(run.poses["seen"], axis=0).tolist()
    cameras = [name for name, on in zip(names, used, strict=True) if on]
    settings = summary.get("settings") or {}
    source = str(summary.get("scale_source"))
    told = [
        ("cameras that saw a person", ", ".join(cameras) or "none"),
        ("frames", f"{len(set(run.poses['frame'].tolist()))}"),
        ("lasts", f"{float(np.ptp(time_s)) if len(time_s) else 0.0:.1f} s"),
        ("people", f"{len(people_of(run.poses))}"),
        ("followed, of frames with a person", _share(summary, "followed")),
        ("believed, of frames with a person", _share(summary, "believed")),
        ("where the cameras are", SCALES.get(source, source)),
        ("mode, working size", f"{settings.get('mode', '')}, {settings.get('size', '')}"),
    ]
    return told


def _share(summary: Facts, name: str) -> str:
    if name not in summary:
        return "not recorded"
    return "no person was found" if summary[name] is None else f"{summary[name]:.0%}"


def trust_lines(summary: Mapping[str, Any]) -> list[str]:
    """What both views say of the calibration, and what to do where it seems wrong."""
    trust: Facts = summary.get("trust") or {}
    if not trust:
        return ["The cameras were not held against each other: one view alone, or too little seen."]
    views = " and ".join(trust.get("cameras", ())) or "both views"
    told = (
        f"{'Believed' if trust['believed'] else 'Not believed'}, by {views} of the person in "
        f"{counted(trust['moments'], 'moment')}: joints {trust['apart_mm']:.0f} mm "
        f"({trust['apart_px']:.1f} px) apart, soles {trust['soles_mm']:+.0f} mm over the floor, a "
        f"person of {trust['stature_m']:.2f} m, facings {trust['facing_deg']:.0f} degrees apart, "
        f"motions {trust['motion_mm']:.0f} mm, {trust['late_frames']:+.1f} frames late."
    )
    return [told, *([f"What to do: {trust['advice']}."] if trust.get("advice") else [])]


def clock_line(summary: Mapping[str, Any]) -> list[str]:
    """The delays of the views: what was applied, and whether it is known."""
    said = clock_words(dict(summary))
    if said:
        return [f"Clocks: {one}." for one in said]
    if "clock" in summary or "clocks" in summary:
        return ["Clocks: the views' times were left as they are."]
    return []
