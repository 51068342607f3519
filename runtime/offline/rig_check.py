"""Whether a run's rig is believable: both views' landmarks are kept and tested at its end."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec

from calibration.tracks.joint_tracks import Row, Sighting, row_of, track_of_rows
from calibration.tracks.lateness import UNSEEN, Clock, clock_of
from common.bus.messages import Body, View, ViewerNumber
from common.npz_file import Facts
from common.video.clip_facts import Clip
from viewer.captured_frame import CapturedFrame

MOST_LATE_FRAMES: Final = 0.75
"""Delay of view 2, frames, above which the clip is tracked again with its times set back."""
DOUBTED: Final = 0.05
"""Factor on the confidence of bodies from views whose times do not match."""
MOST_FRAMES: Final = 3_000
"""Number of a run's latest frames that are kept."""


class Seen(NamedTuple):
    """The observations so far."""

    rows: dict[int, list[Row]]
    """By view."""
    moved: bool = False
    """A camera was moved."""


class Witness:
    """Keeps the landmarks of all views, instant by instant, while no camera is moved."""

    def __init__(self) -> None:
        """No observation yet."""
        self.seen = Seen({})

    def __call__(
        self, _: dict[ViewerNumber, CapturedFrame], reports: dict[int, View], body: Body
    ) -> None:
        """Process one instant; observations after a move do not count against the given rig."""
        self.seen = self.seen._replace(moved=self.seen.moved or bool(body.moved))
        if self.seen.moved:
            return
        for number, report in reports.items():
            rows = self.seen.rows.setdefault(number, [])
            if len(rows) < MOST_FRAMES:
                rows.append(row_of(report))

    def sighting(self, clip: Clip) -> Sighting | None:
        """Both views of a clip; None where it has one view, or more than two."""
        if len(clip.views) != 2:
            return None
        first, second = (track_of_rows(self.seen.rows.get(v.number, [])) for v in clip.views)
        return Sighting(first, second, clip.views[0].size)


def clock_seen(clip: Clip, witness: Witness) -> Clock:
    """The clock of view 2, by all observations; unknown for one view, or more than two."""
    sighting = witness.sighting(clip)
    return UNSEEN if sighting is None else clock_of(sighting)


def unchecked(clip: Clip) -> list[str]:
    """The note for a clip with too many cameras to check clocks and calibration."""
    if len(clip.views) <= 2:
        return []
    return [
        f"of {len(clip.views)} cameras it is not checked whether they run together, nor whether "
        "the calibration is believable: track two of them for that (--views 1,2)"
    ]


def is_late(clip: Clip, clock: Clock) -> bool:
    """Whether view 2 is late by more than MOST_LATE_FRAMES."""
    period_s = clip.every / clip.views[0].fps
    return clock.is_found and abs(clock.late_s) > MOST_LATE_FRAMES * period_s


def trust_facts(
    clip: Clip, witness: Witness, clock: Clock, *, insisted: bool, different_people: bool = False
) -> Facts:
    """For the summary: the rig's assessment, and the cure where it is not believable.

    Args:
        clip: The tracked clip.
        witness: Observations of both views.
        clock: Clock of view 2, as the clip has it.
        insisted: The user trusts the calibration: no advice is given.
        different_people: The views followed different people for a time: what contradicts the rig
            is not evidence against it.
    """
    from calibration.gate.rig_fault import advice_on
    from calibration.gate.rig_trust import trust_of

    sighting = witness.sighting(clip)
    if clip.rig is None or sighting is None or len(sighting.second.times_s) < 2:
        return {}
    period_s = clip.every / clip.views[0].fps
    trust = trust_of(clip.rig, sighting, period_s, clock)
    if trust is None or (different_people and not trust.believed):
        return {}
    if not insisted:
        advice = advice_on(clip.rig, sighting, period_s, trust, clock, clip.views[1].late_s)
        trust = msgspec.structs.replace(trust, advice=advice)
    return {"trust": msgspec.to_builtins(trust)}


def doubts(facts: Facts) -> list[str]:
    """The warning about a rig that is not believable."""
    trust = facts.get("trust")
    if not trust or not trust["advice"]:
        return []
    told = (
        "views {apart_mm:.0f} mm ({apart_px:.1f} px) apart, soles {soles_mm:+.0f} mm over the "
        "floor, a person of {stature_m:.2f} m, facings {facing_deg:.0f} degrees apart, motions "
        "{motion_mm:.0f} mm, view 2 {late_frames:+.1f} frames late; {advice}"
    )
    return [f"the calibration is not believable: {told.format(**trust)}"]


def clock_facts(clip: Clip, clock: Clock, given_s: float | None) -> Facts:
    """For the summary: the time by which view 2 was set back, and other possible delays.

    Args:
        clip: The tracked clip.
        clock: Clock of view 2, by the times of its files and the user's offset.
        given_s: The user's offset.
    """
    if len(clip.views) != 2:
        return {}
    state = "given" if given_s is not None else clock.state
    rivals_s = sorted((clock.late_s, *clock.rivals_s)) if clock.rivals_s else []
    applied_s = round(clip.views[1].late_s, 4)
    may_be_s = [round(late_s, 2) + 0.0 for late_s in rivals_s] if state == "ambiguous" else []
    on_time = state != "ambiguous" or clock.may_be_on_time
    return {
        "clock": {
            "state": state,
            "applied_s": applied_s,
            "may_be_s": may_be_s,
            "may_be_on_time": on_time,
        }
    }


def doubted(bodies: Sequence[Body], clock: Clock) -> Sequence[Body]:
    """The bodies, with little confidence where view 2 has an unknown delay."""
    if clock.state != "ambiguous" or clock.may_be_on_time:
        return bodies
    return [
        msgspec.structs.replace(body, confidence=tuple(DOUBTED * each for each in body.confidence))
        for body in bodies
    ]


def clock_word(facts: Facts) -> str:
    """The warning about the clock of view 2; "" where the files' times may be right."""
    told = facts.get("clock")
    if not told or (told["may_be_on_time"] and not told["applied_s"]):
        return ""
    if told["state"] != "ambiguous":
        return f"view 2 is {told['applied_s']:+.2f} s late: its times were set back by that"
    several = ", ".join(f"{late_s:+.2f}" for late_s in told["may_be_s"])
    return (
        f"how late view 2 is, the motion does not show, as a gait repeats itself ({several} s): "
        "its times were left as they are, and joints are hardly believed; say it by --offset "
        "SECONDS"
    )
