"""Whether a run's rig is believable: all views' landmarks are kept and tested at its end."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import msgspec

from calibration.tracks.camera_clocks import Clocks, clocks_of
from calibration.tracks.joint_tracks import Row, Sightings, longest_seen, row_of, track_of_rows
from calibration.tracks.lateness import Clock
from common.bus.messages import Body, View, ViewerNumber
from common.npz_file import Facts
from common.rig.camera import Rig
from common.video.clip_facts import Clip, ClipView
from common.video.clip_sources import Offsets
from viewer.captured_frame import CapturedFrame

if TYPE_CHECKING:
    from calibration.gate.pair_trust import PairTrust

MOST_LATE_FRAMES: Final = 0.75
"""Delay of a view, frames, above which the clip is tracked again with its times set back."""
DOUBTED: Final = 0.05
"""Factor on the confidence of bodies from views whose times do not match."""
MOST_FRAMES: Final = 3_000
"""Number of a person's first frames that are kept."""
MOST_PEOPLE: Final = 12
"""Number of people whose observations are kept, so that a long run's do not grow: each new person
has another number. Twice as many as are known at once."""
NONE: Final[Offsets] = {}


class Seen(NamedTuple):
    """The observations so far."""

    rows: dict[int, dict[int, list[Row]]]
    """By person's number, then by view."""
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
        """Process a person's views of one instant; observations after a move do not count against
        the given rig."""
        self.seen = self.seen._replace(moved=self.seen.moved or bool(body.moved))
        if self.seen.moved:
            return
        people = self.seen.rows
        if body.person not in people and len(people) >= MOST_PEOPLE:
            del people[min(people, key=lambda number: _most_rows(people[number]))]
        own = people.setdefault(body.person, {})
        for number, report in reports.items():
            rows = own.setdefault(number, [])
            if len(rows) < MOST_FRAMES:
                rows.append(row_of(report))

    def sightings(self, clip: Clip) -> tuple[Sightings, ...]:
        """All views of each person, who was seen longest first; none where a clip has one view."""
        if len(clip.views) < 2:
            return ()
        each = [
            Sightings(
                tuple(track_of_rows(rows.get(view.number, [])) for view in clip.views),
                clip.views[0].size,
            )
            for rows in self.seen.rows.values() or [{}]
        ]
        return longest_seen(each)


def _most_rows(rows: Mapping[int, Sequence[Row]]) -> int:
    """Number of rows of the view that has most."""
    return max(map(len, rows.values()), default=0)


def clocks_seen(clip: Clip, witness: Witness) -> Clocks:
    """The clocks of the views after the first, by all observations of who was seen longest."""
    seen = witness.sightings(clip)
    return clocks_of(seen[0]) if seen else ()


def late_by(clip: Clip, clocks: Clocks, given: Offsets) -> tuple[float, ...]:
    """Delays of the views after the first that are found, and above MOST_LATE_FRAMES; else 0.

    Args:
        clip: The tracked clip.
        clocks: Clocks of these views.
        given: Cameras whose offset the user gives.
    """
    most_s = MOST_LATE_FRAMES * clip.every / clip.views[0].fps
    return tuple(
        clock.late_s
        if clock.is_found and abs(clock.late_s) > most_s and view.number not in given
        else 0.0
        for view, clock in zip(clip.views[1:], clocks, strict=False)
    )


def trust_facts(
    clip: Clip, witness: Witness, clocks: Clocks, *, insisted: bool, different_people: bool = False
) -> Facts:
    """For the summary: the rig's assessment, and the cure where it is not believable.

    Of more than two cameras the pair is assessed that is believed least; of several people by the
    person who agrees best with the rig: a wrong one contradicts everybody, a mistake about who is
    who in a view one of them.

    Args:
        clip: The tracked clip.
        witness: Observations of all views.
        clocks: Clocks of the views after the first, as the clip has them.
        insisted: The user trusts the calibration: no advice is given.
        different_people: The views followed different people for a time: what contradicts the rig
            is not evidence against it.
    """
    from calibration.gate.pair_trust import advice_of

    everyone = [
        seen
        for seen in witness.sightings(clip)
        if len(seen.tracks[0].times_s) and any(len(track.times_s) >= 2 for track in seen.tracks[1:])
    ]
    if clip.rig is None or not everyone:
        return {}
    period_s, names = clip.every / clip.views[0].fps, [view.name for view in clip.views]
    rig = _renamed(clip.rig, names)
    found, seen = _judged(rig, everyone, period_s, clocks)
    if found is None or (different_people and not found.trust.believed):
        return {}
    one, other, trust = found
    if not insisted:
        late_s = clip.views[other].late_s
        advice = advice_of(found, rig, seen, period_s, clocks, late_s)
        trust = msgspec.structs.replace(trust, advice=advice)
    several = {"cameras": [names[one], names[other]]} if len(names) > 2 else {}
    return {"trust": {**msgspec.to_builtins(trust), **several}}


def _judged(
    rig: Rig, everyone: Sequence[Sightings], period_s: float, clocks: Clocks
) -> tuple["PairTrust | None", Sightings]:
    """The verdict by the first person who believes the rig, else by the first who can judge it."""
    from calibration.gate.pair_trust import least_believed

    verdicts = [(least_believed(rig, seen, period_s, clocks), seen) for seen in everyone]
    judged = [each for each in verdicts if each[0] is not None]
    believing = (each for each in judged if each[0] is not None and each[0].trust.believed)
    return next(believing, (judged or verdicts)[0])


def _renamed(rig: Rig, names: Sequence[str]) -> Rig:
    """The rig with the names of the clip's cameras, by which the settings know them."""
    cameras = zip(rig.cameras, names, strict=True)
    own = (msgspec.structs.replace(camera, name=name) for camera, name in cameras)
    return msgspec.structs.replace(rig, cameras=tuple(own))


def doubts(facts: Facts) -> list[str]:
    """The warning about a rig that is not believable."""
    trust = facts.get("trust")
    if not trust or not trust["advice"]:
        return []
    views, late = "views", "view 2"
    if "cameras" in trust:
        views, late = " and ".join(trust["cameras"]), trust["cameras"][1]
    told = (
        "{views} {apart_mm:.0f} mm ({apart_px:.1f} px) apart, soles {soles_mm:+.0f} mm over the "
        "floor, a person of {stature_m:.2f} m, facings {facing_deg:.0f} degrees apart, motions "
        "{motion_mm:.0f} mm, {late} {late_frames:+.1f} frames late; {advice}"
    )
    said = told.format(views=views, late=late, **trust)
    return [f"the calibration is not believable: {said}"]


def clock_facts(clip: Clip, clocks: Clocks, given: Offsets, heard: Offsets = NONE) -> Facts:
    """For the summary: the time by which each view after the first was set back, and other
    possible delays. Of two views `clock`, of more `clocks`, by camera.

    Args:
        clip: The tracked clip.
        clocks: Clocks of these views, by the times of their files and the user's offsets.
        given: The user's offsets, by camera number.
        heard: Those of them that the videos' sounds tell.
    """
    told = {
        view.name: _told(view, clock, _stated(view.number, given, heard))
        for view, clock in zip(clip.views[1:], clocks, strict=False)
    }
    if len(clip.views) == 2:
        return {"clock": told[clip.views[1].name]} if told else {}
    return {"clocks": told} if told else {}


def _stated(number: ViewerNumber, given: Offsets, heard: Offsets) -> str:
    if number in heard:
        return "heard"
    return "given" if number in given else ""


def _told(view: ClipView, clock: Clock, stated: str) -> Facts:
    """A view's clock; `stated`: given or heard, where the motion was not asked."""
    state = stated or clock.state
    rivals_s = sorted((clock.late_s, *clock.rivals_s)) if clock.rivals_s else []
    may_be_s = [round(late_s, 2) + 0.0 for late_s in rivals_s] if state == "ambiguous" else []
    return {
        "state": state,
        "applied_s": round(view.late_s, 4),
        "may_be_s": may_be_s,
        "may_be_on_time": state != "ambiguous" or clock.may_be_on_time,
    }


def doubted(bodies: Sequence[Body], clip: Clip, clocks: Clocks, given: Offsets) -> Sequence[Body]:
    """The bodies, with little confidence where a view has an unknown delay."""
    timed = zip(clip.views[1:], clocks, strict=False)
    unknown = [clock for view, clock in timed if view.number not in given]
    if all(clock.state != "ambiguous" or clock.may_be_on_time for clock in unknown):
        return bodies
    return [
        msgspec.structs.replace(body, confidence=tuple(DOUBTED * each for each in body.confidence))
        for body in bodies
    ]


def clock_words(facts: Facts) -> list[str]:
    """The warnings about views' clocks; none where the files' times may be right."""
    if "clock" in facts:
        said = _word("view 2", facts["clock"], "--offset SECONDS")
        return [said] if said else []
    told = facts.get("clocks", {}).items()
    words = (_word(name, each, f"cameras.{name}.offset_s in the settings") for name, each in told)
    return [*filter(None, words)]


def _word(view: str, told: Facts, how: str) -> str:
    if told["may_be_on_time"] and not told["applied_s"]:
        return ""
    if told["state"] != "ambiguous":
        ear = ", as the sound tells" if told["state"] == "heard" else ""
        return f"{view} is {told['applied_s']:+.2f} s late: its times were set back by that{ear}"
    several = ", ".join(f"{late_s:+.2f}" for late_s in told["may_be_s"])
    return (
        f"how late {view} is, the motion does not show, as a gait repeats itself ({several} s): "
        f"its times were left as they are, and joints are hardly believed; say it by {how}"
    )
