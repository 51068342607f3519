"""Which two cameras of a rig are believed least, and which of them is to blame."""

import re
from itertools import combinations
from typing import Final, NamedTuple

import msgspec

from calibration.gate.rig_fault import AGAIN, advice_on
from calibration.gate.rig_trust import Trust, trust_of
from calibration.tracks.camera_clocks import Clocks, clock_between
from calibration.tracks.joint_tracks import Sightings
from common.rig.camera import Rig

MOST_DOUBTED: Final = 0.5
"""Share of a camera's pairs that must not be believed for a doubt: a wrong camera is wrong in most
of its pairs, and a pair that looks from nearly opposite sides errs by itself."""
OF_A_PAIR: Final = re.compile(r"(camera|view) ([12])\b")
"""What an advice on two cameras calls them."""


class PairTrust(NamedTuple):
    """Assessment of two cameras of a rig."""

    first: int
    second: int
    """Their places in the rig, from 0; where they are not believed, the second one is to blame."""
    trust: Trust


Pair = tuple[int, int]


def least_believed(rig: Rig, seen: Sightings, period_s: float, clocks: Clocks) -> PairTrust | None:
    """The two cameras that are believed least; None where too little is seen.

    Any two are compared. To blame is the camera of which most pairs are not believed; the rig is
    believed where of each camera fewer than half are not.

    Args:
        rig: All cameras.
        seen: All views of the person, in the rig's order.
        period_s: Time between frames.
        clocks: Delays of the views after the first.
    """
    found: dict[Pair, Trust] = {}
    for one, other in combinations(range(len(rig.cameras)), 2):
        clock = clock_between(clocks, one, other)
        trust = trust_of(_of(rig, one, other), seen.pair(one, other), period_s, clock)
        found |= {} if trust is None else {(one, other): trust}
    blamed = max(range(len(rig.cameras))[::-1], key=lambda n: _doubt(n, found))
    if _doubt(blamed, found)[0] < MOST_DOUBTED:
        good = [pair for pair, trust in found.items() if trust.believed]
        most = max(good, key=lambda pair: found[pair].apart_mm, default=None)
        return None if most is None else PairTrust(*most, found[most])
    partner = max(
        (pair for pair in found if blamed in pair and not found[pair].believed),
        key=lambda pair: found[pair].apart_mm,
    )
    other = partner[0] if partner[1] == blamed else partner[1]
    return PairTrust(other, blamed, found[partner])


def advice_of(
    found: PairTrust, rig: Rig, seen: Sightings, period_s: float, clocks: Clocks, late_s: float
) -> str:
    """The likeliest cause and its cure in one line, with the cameras' names; "" for a believable
    rig.

    Args:
        found: The pair that is believed least.
        rig: All cameras.
        seen: All views of the person.
        period_s: Time between frames.
        clocks: Delays of the views after the first.
        late_s: Time by which the second view of the pair was already set back.
    """
    one, other, trust = found
    if trust.believed:
        return ""
    names = [rig.cameras[n].name for n in (one, other)]
    if trust.odd == ("late",) and len(rig.cameras) > 2:
        late_s += trust.late_frames * period_s
        return (
            f"{names[1]} is {trust.late_frames:+.1f} frames late: set "
            f"cameras.{names[1]}.offset_s = {late_s:.2f} in the settings, or start all "
            f"cameras by one signal; else {AGAIN}"
        )
    pair, clock = _of(rig, one, other), clock_between(clocks, one, other)
    said = advice_on(pair, seen.pair(one, other), period_s, trust, clock, late_s)
    if len(rig.cameras) == 2:
        return said
    return OF_A_PAIR.sub(lambda found: names[int(found[2]) - 1], said)


def _of(rig: Rig, one: int, other: int) -> Rig:
    """Two of a rig's cameras."""
    return msgspec.structs.replace(rig, cameras=(rig.cameras[one], rig.cameras[other]))


def _doubt(number: int, found: dict[Pair, Trust]) -> tuple[float, float]:
    """The share of a camera's pairs that are not believed, and how far apart its pairs are."""
    own = [trust for pair, trust in found.items() if number in pair]
    if not own:
        return 0.0, 0.0
    bad = sum(not trust.believed for trust in own)
    return bad / len(own), sum(trust.apart_mm for trust in own) / len(own)
