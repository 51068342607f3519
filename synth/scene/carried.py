"""The thing that people hand to each other."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from common.body.body import Vector
from synth.motion.motions import MOTION
from synth.motion.moves import smooth
from synth.person.people import Colour
from synth.person.skeleton import JOINTS
from synth.picture.actors import Part, Thing
from synth.scene.plot import Contact

HANDED: Final = "hand over"
"""Name of the contacts in which a thing goes from hand to hand."""
SIDES_M: Final = (0.16, 0.2, 0.1)
PASSES_S: Final = 0.3
"""Duration of its way from hand to hand."""
COLOURS: Final[tuple[Colour, ...]] = ((60, 60, 200), (60, 170, 220), (190, 120, 40), (70, 150, 60))
HAND: Final = JOINTS.index("r_knuckle")


def carried(parts: Sequence[Part], contacts: Sequence[Contact], fps: float) -> tuple[Thing, ...]:
    """The thing of a scene: the first who hands one over has it from the opening on.

    Args:
        parts: The people.
        contacts: Who touches whom, in order of time; one without whoever holds the thing is a
            gesture only.
        fps: Frames per second.

    Returns:
        None or one.
    """
    handed = [contact for contact in contacts if contact.name == HANDED]
    if not handed:
        return ()
    hands = [part.motion.joints_m[:, HAND] for part in parts]
    time_s = np.arange(len(hands[0])) / fps
    holder = handed[0].people[0]
    posing = parts[holder].motion.phase[:, None] < MOTION
    places: Vector = np.where(posing, np.nan, hands[holder])
    for contact in handed:
        if holder not in contact.people:
            continue
        taker = contact.people[contact.people[0] == holder]
        middle_s = (contact.from_s + contact.to_s) / 2
        share = smooth((time_s - middle_s) / PASSES_S + 0.5)[:, None]
        places = np.where(share >= 1.0, hands[taker], places)
        passes = (share > 0.0) & (share < 1.0)
        places = np.where(passes, (1.0 - share) * hands[holder] + share * hands[taker], places)
        holder = taker
    colour = COLOURS[parts[0].someone.seed % len(COLOURS)]
    return (Thing(SIDES_M, colour, places - [0.0, SIDES_M[1] / 2, 0.0]),)
