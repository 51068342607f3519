"""The stick body of a single view, in its report (thesis 3.1.4)."""

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.observation import Observation
from common.body.proportions import body_vector, stature
from common.method import Method
from common.raster.similarity import Mask
from viewer.expected_body import ExpectedBody
from viewer.paper.posed_model import view_at
from viewer.stick import stick_fit
from viewer.stick.standing_height import Standing


def with_stick(
    person: Observation,
    mask: Mask,
    rotation: NDArray[np.float64],
    known: ExpectedBody | None,
    standing: Standing | None,
    method: Method,
) -> Observation:
    """The person with the stick body that fits their silhouette; unchanged where none does.

    Args:
        person: The person without a stick body.
        mask: (H, W) the silhouette.
        rotation: World to camera, (3, 3).
        known: The body that is followed.
        standing: Height of the standing person; None: as predicted, or as seen.
        method: How to fit.
    """
    stature_px, expected = float(person.box.bottom + 1 - person.box.top), None
    if known is not None:
        stature_px = known.scale_px_per_m * stature(known.bdp)
        view = view_at(rotation, known.scale_px_per_m, known.root_px)
        body, pose = body_vector(known.bdp), np.array(known.pose)
        expected = stick_fit.expected(body, pose, view, stature_px)
    if standing is not None:
        stature_px = standing.at(person.box.bottom + 1)
    try:
        fitted = stick_fit.fit(mask, expected, stature_px, method)
    except stick_fit.NoFit:
        return person
    return msgspec.structs.replace(person, stick=stick_fit.fit_of(fitted))
