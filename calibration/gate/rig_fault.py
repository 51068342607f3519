"""The likeliest fault of a rig that is not believable, and the cure."""

import math
from typing import Final, NamedTuple

import msgspec
import numpy as np

from calibration.gate.rig_trust import Case, Trust, case_of, trust_of, with_lateness
from calibration.gate.sight_clash import CLASHES_M, is_of_different_people
from calibration.person.rig_fit import fitted
from calibration.person.rig_residuals import FEWEST_FACINGS, SURE_FACING
from calibration.tracks.joint_tracks import Sighting, at_times
from calibration.tracks.lateness import Clock, clock_of
from calibration.tracks.rig_guess import BODY, FOCALS, LATE, PLACE
from common.body.body import Vector
from common.rig.camera import Camera, Rig, as_matrix

SIZES: Final = (0.25, 1 / 3, 0.5, 2 / 3, 0.75, 4 / 3, 1.5, 2.0, 3.0, 4.0)
"""Scale factors of the pictures that a calibration may have been made for."""
FREED: Final = {
    "turned": ("yaw_2", "pitch_2", "roll_2"),
    "focal": ("log_focal_1", "log_focal_2"),
    "moved": ("x_2", "height_2", "z_2"),
    "floor": ("height_1", "height_2"),
}
"""Single faults, and the numbers of the guess that would mend each."""
ONE_SIDE_DEG: Final = 15.0
"""Median facing difference, degrees, below which both views show one side of the person. Two
cameras must differ by the angle between them, 30 at least."""
SIMPLER: Final = 1.0
"""Log likelihood that each additional number must gain."""
AGAIN: Final = "calibrate again (tritrack calibrate person), or go on with --trust-calibration"


class _Mended(NamedTuple):
    name: str
    cost: float
    change: Vector
    """Change of the guess."""


def advice_on(
    rig: Rig,
    sighting: Sighting,
    period_s: float,
    trust: Trust,
    clock: Clock | None = None,
    set_back_s: float = 0.0,
) -> str:
    """The likeliest cause in one line, with its size; "" for a believable rig.

    Args:
        rig: Both cameras.
        sighting: Both views of the person.
        period_s: Time between frames.
        trust: The rig's assessment.
        clock: Clock of view 2; None: it is estimated.
        set_back_s: Time by which view 2 was already set back: an offset that the user states
            replaces that.
    """
    if trust.believed:
        return ""
    if _is_one_side(sighting):
        return (
            "both views show the person from one side, as two videos of one camera do: name the "
            f"videos of two cameras; else {AGAIN}"
        )
    clock = clock or clock_of(sighting)
    if trust.apart_mm > 1e3 * CLASHES_M and is_of_different_people(sighting, clock.late_s):
        return (
            "the views follow different people: they have no relation that any two cameras would "
            "have; see that both show one person, and name the videos of one take"
        )
    if "facing" in trust.odd:
        other = trust_of(exchanged_rig(rig), sighting, period_s, clock)
        if other is not None and "facing" not in other.odd:
            return f"the cameras are exchanged: change their order; else {AGAIN}"
    if trust.odd == ("late",):
        return _advice_on_clock(trust, clock, period_s, set_back_s)
    if "motion" in trust.odd and not {"apart", "stature"} & set(trust.odd):
        return (
            "the views do not show one motion: see that both are of one take, and that their "
            f"clocks are less than seconds apart; else {AGAIN}"
        )
    size = _size(rig, sighting, period_s, clock)
    if size:
        return (
            f"the calibration is for pictures {size:.3g} times as large: correct its width and "
            f"height; else {AGAIN}"
        )
    case = case_of(rig, sighting, clock)
    return f"{_told(_mended(case))}: {AGAIN}" if case else AGAIN


def _advice_on_clock(trust: Trust, clock: Clock, period_s: float, set_back_s: float) -> str:
    """The line about view 2's delay, where that alone is odd."""
    if clock.rivals_s:
        candidates_s = sorted(set_back_s + late for late in (clock.late_s, *clock.rivals_s))
        several = ", ".join(f"{late_s:+.2f}" for late_s in candidates_s)
        return f"the motion does not show which of {several} s: say it by --offset SECONDS"
    late_s = set_back_s + trust.late_frames * period_s
    return (
        f"view 2 is {trust.late_frames:+.1f} frames late: say so "
        f"(--offset {late_s:.2f}), or start both cameras by one signal"
    )


def _is_one_side(sighting: Sighting) -> bool:
    """Whether the person mostly faces both cameras alike, wherever they stand."""
    first, second = sighting.first, at_times(sighting.second, sighting.first.times_s)
    sure = np.minimum(first.facing_confidence, second.facing_confidence) > SURE_FACING
    turned = np.radians(first.facing_deg - second.facing_deg)[sure]
    off_deg = np.degrees(np.abs(np.angle(np.exp(1j * turned))))
    return len(off_deg) >= FEWEST_FACINGS and float(np.median(off_deg)) < ONE_SIDE_DEG


def exchanged_rig(rig: Rig) -> Rig:
    """The rig with its cameras swapped."""
    first, second = rig.cameras
    return msgspec.structs.replace(rig, cameras=(second, first))


def _size(rig: Rig, sighting: Sighting, period_s: float, clock: Clock) -> float:
    """Scale of the pictures for which the calibration would be believable; 0: none."""
    for size in SIZES:
        cameras = tuple(_scaled(camera, 1 / size) for camera in rig.cameras)
        smaller = msgspec.structs.replace(rig, cameras=cameras)
        trust = trust_of(smaller, sighting, period_s, clock)
        if trust is not None and not {"apart", "floor", "stature"} & set(trust.odd):
            return size
    return 0.0


def _scaled(camera: Camera, scale: float) -> Camera:
    K = np.diag([scale, scale, 1.0]) @ np.array(camera.K)
    return msgspec.structs.replace(camera, K=as_matrix(K))


def _mended(case: Case) -> _Mended:
    """The single fault whose cure explains most of the observations."""
    start = with_lateness(case).guess
    found = []
    for name, freed in FREED.items():
        free = np.zeros(len(start), np.bool_)
        free[[PLACE[each] for each in freed]] = True
        free[BODY] = free[LATE] = True
        fit = fitted(start, case.evidence, free, 2, 8)
        found.append(_Mended(name, fit.cost + SIMPLER * len(freed), fit.guess - start))
    return min(found, key=lambda each: each.cost)


def _told(fault: _Mended) -> str:
    change = fault.change
    if fault.name == "turned":
        by = [math.degrees(change[PLACE[name]]) for name in FREED["turned"]]
        return f"camera 2 seems turned by {math.hypot(*by):.0f} degrees against camera 1"
    if fault.name == "focal":
        share = float(np.abs(np.expm1(change[FOCALS])).max())
        return f"the focal lengths seem {share:.0%} wrong"
    if fault.name == "moved":
        far_m = float(np.linalg.norm([change[PLACE[name]] for name in FREED["moved"]]))
        return f"camera 2 seems to stand {far_m:.1f} m from where the calibration has it"
    rise_m = float(np.mean([change[PLACE[name]] for name in FREED["floor"]]))
    side = "below" if rise_m > 0 else "above"
    return f"the floor seems {abs(rise_m):.2f} m {side} its place, or all lengths are wrong"
