"""Whether the rig of a run is believable: what both viewers saw is kept and asked at its end."""

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
"""A view 2 that is late by more than this, in frames, is tracked again with its times set back."""
DOUBTED: Final = 0.05
"""Share of the confidence that is left to bodies of views that do not belong together in time."""
MOST_FRAMES: Final = 3_000
"""So much of a run is kept."""


class Seen(NamedTuple):
    """What was seen until now."""

    rows: dict[int, list[Row]]
    """Of each view that was heard of."""
    moved: bool = False
    """A camera was moved."""


class Witness:
    """Keeps the landmarks of all views, instant by instant, while the cameras stand."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self.seen = Seen({})

    def __call__(
        self, _: dict[ViewerNumber, CapturedFrame], reports: dict[int, View], body: Body
    ) -> None:
        """One instant more; the given rig is not held against what is seen after a move."""
        self.seen = self.seen._replace(moved=self.seen.moved or bool(body.moved))
        if self.seen.moved:
            return
        for number, report in reports.items():
            rows = self.seen.rows.setdefault(number, [])
            if len(rows) < MOST_FRAMES:
                rows.append(row_of(report))

    def sighting(self, clip: Clip) -> Sighting | None:
        """What both views of a clip saw; None where it has one view, or more than two."""
        if len(clip.views) != 2:
            return None
        first, second = (track_of_rows(self.seen.rows.get(v.number, [])) for v in clip.views)
        return Sighting(first, second, clip.views[0].size)


def clock_seen(clip: Clip, witness: Witness) -> Clock:
    """The clock of view 2, by all that both views saw; not known of one, or of more than two."""
    sighting = witness.sighting(clip)
    return UNSEEN if sighting is None else clock_of(sighting)


def unchecked(clip: Clip) -> list[str]:
    """What to say of a clip of more cameras than clocks and calibration can be checked of."""
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


def trust_facts(clip: Clip, witness: Witness, clock: Clock, *, insisted: bool) -> Facts:
    """For the summary: how far the rig is to be believed, and what to do where it is not.

    Args:
        clip: What was tracked.
        witness: What both views saw in it.
        clock: Of view 2, as the clip has it.
        insisted: The user trusts the calibration: nothing is advised.
    """
    from calibration.gate.rig_fault import advice_on
    from calibration.gate.rig_trust import trust_of

    sighting = witness.sighting(clip)
    if clip.rig is None or sighting is None or len(sighting.second.times_s) < 2:
        return {}
    period_s = clip.every / clip.views[0].fps
    trust = trust_of(clip.rig, sighting, period_s, clock)
    if trust is None:
        return {}
    if not insisted:
        advice = advice_on(clip.rig, sighting, period_s, trust, clock, clip.views[1].late_s)
        trust = msgspec.structs.replace(trust, advice=advice)
    return {"trust": msgspec.to_builtins(trust)}


def doubts(facts: Facts) -> list[str]:
    """What to say of a rig that is not believable."""
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
    """For the summary: by how much view 2 was set back in time, and which other latenesses fit.

    Args:
        clip: As it was tracked.
        clock: Of view 2, by the times that its files tell and what the user says.
        given_s: How late the user says that it is.
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
    """The bodies, hardly believed where view 2 is late and nobody knows by how much."""
    if clock.state != "ambiguous" or clock.may_be_on_time:
        return bodies
    return [
        msgspec.structs.replace(body, confidence=tuple(DOUBTED * each for each in body.confidence))
        for body in bodies
    ]


def clock_word(facts: Facts) -> str:
    """What to say of the clock of view 2; "" where nothing speaks against the files' times."""
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
