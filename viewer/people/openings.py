"""The opening posture of each person in a frame, where no other is in the way."""

from collections.abc import Sequence
from typing import Final

import cv2
import msgspec
import numpy as np

from common.body.observation import Measure, Observation
from common.bus.messages import Guide, View
from common.raster.silhouette_report import unpack
from common.raster.similarity import Mask
from viewer.paper.measure import measure_front, measure_side, opening_measure, refusal_of

NEAR_PX: Final = 2
"""Distance of two silhouettes, pixels, up to which they touch."""
TOUCHED: Final = "another person is in the way: stand apart"


def with_opening(view: View, mask: Mask, guide: Guide | None) -> View:
    """The view with the measures of the followed person, or why this is another posture.

    Args:
        view: With at least one person.
        mask: (H, W) the followed person's silhouette.
        guide: The integrator's guide after the frame before; None at the start.
    """
    first, *others = view.people
    facing = first.vote if guide is None else guide.facing[view.viewer - 1]
    measure, refusal = opening_measure(mask, first, guide, facing)
    if measure is not None and is_touched(first, mask, others):
        measure, refusal = None, TOUCHED
    first = msgspec.structs.replace(first, measure=measure, refusal=refusal)
    return msgspec.structs.replace(view, people=(first, *others))


def with_openings(view: View) -> View:
    """The same of everybody: a silhouette of the posture itself is of the facade, any other may be
    the flank of somebody who takes it."""
    masks = [unpack(person) for person in view.people]
    people = []
    for person, mask in zip(view.people, masks, strict=True):
        measure, refusal = _opening_of(person, mask, view.people)
        people.append(msgspec.structs.replace(person, measure=measure, refusal=refusal))
    return msgspec.structs.replace(view, people=tuple(people))


def _opening_of(
    person: Observation, mask: Mask, people: Sequence[Observation]
) -> tuple[Measure | None, str]:
    """The measures of one of several, or why there are none."""
    if person.cut:
        return None, "the person is partly outside the picture"
    if is_touched(person, mask, [other for other in people if other is not person]):
        return None, TOUCHED
    if refusal := refusal_of(mask, person.box):
        return measure_side(mask, person.box), refusal
    return measure_front(mask, person.box), ""


def is_touched(person: Observation, mask: Mask, others: Sequence[Observation]) -> bool:
    """Whether a silhouette touches another person's: its arms may then be the other's.

    Args:
        person: Whose silhouette it is.
        mask: (H, W) the silhouette.
        others: All other people in the picture.
    """
    near = [other for other in others if person.box.meets(other.box, NEAR_PX)]
    if not near:
        return False
    wide = cv2.dilate(mask.view(np.uint8), np.ones((2 * NEAR_PX + 1,) * 2, np.uint8))
    return any(bool((unpack(other) & wide.view(np.bool_)).any()) for other in near)
