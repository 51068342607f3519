"""Whether the rig of a run is believable: what both viewers saw is kept and asked at its end."""

from typing import Any, Final, NamedTuple

import msgspec

from common.bus.messages import Body, Report, ViewerNumber
from common.video.clip_facts import Clip
from integrator.selfcalibration.joint_tracks import Row, Sighting, row_of, track_of_rows
from viewer.capture import CapturedFrame

MOST_FRAMES: Final = 3_000
"""So much of a run is kept."""


class Seen(NamedTuple):
    """What was seen until now."""

    rows: dict[int, list[Row]]
    """Of each view."""
    moved: bool = False
    """A camera was moved."""


class Witness:
    """Keeps the landmarks of both views, instant by instant, while the cameras stand."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self.seen = Seen({1: [], 2: []})

    def __call__(
        self, _: dict[ViewerNumber, CapturedFrame], reports: dict[int, Report], body: Body
    ) -> None:
        """One instant more; the given rig is not held against what is seen after a move."""
        self.seen = self.seen._replace(moved=self.seen.moved or bool(body.moved))
        if self.seen.moved:
            return
        for number, report in reports.items():
            if len(self.seen.rows[number]) < MOST_FRAMES:
                self.seen.rows[number].append(row_of(report))

    def sighting(self, clip: Clip) -> Sighting:
        """What both saw."""
        first, second = (track_of_rows(self.seen.rows[number]) for number in (1, 2))
        return Sighting(first, second, clip.views[0].size)


def trust_facts(clip: Clip, witness: Witness, *, insisted: bool) -> dict[str, Any]:
    """For the summary: how far the rig is to be believed, and what to do where it is not.

    Args:
        clip: What was tracked.
        witness: What both views saw in it.
        insisted: The user trusts the calibration: nothing is advised.
    """
    from integrator.rig_gate.rig_fault import advice_on
    from integrator.rig_gate.rig_trust import trust_of

    sighting = witness.sighting(clip)
    if clip.rig is None or len(clip.views) < 2 or len(sighting.second.times_s) < 2:
        return {}
    period_s = clip.every / clip.views[0].fps
    trust = trust_of(clip.rig, sighting, period_s)
    if trust is None:
        return {}
    if not insisted:
        advice = advice_on(clip.rig, sighting, period_s, trust)
        trust = msgspec.structs.replace(trust, advice=advice)
    return {"trust": msgspec.to_builtins(trust)}


def doubts(facts: dict[str, Any]) -> list[str]:
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
