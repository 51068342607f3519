"""The stick body of a view that is alone, in its report (thesis 3.1.4)."""

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.proportions import body_vector, stature
from common.bus.messages import Report
from common.method import Method
from common.raster.similarity import Mask
from viewer.expected_body import ExpectedBody
from viewer.paper.posed_model import view_at
from viewer.stick import stick_fit
from viewer.stick.standing_height import Standing


def with_stick(
    report: Report,
    mask: Mask,
    rotation: NDArray[np.float64],
    known: ExpectedBody | None,
    standing: Standing | None,
    method: Method,
) -> Report:
    """The report with the stick body that fits its silhouette; as it is where none does.

    Args:
        report: Of a person.
        mask: (H, W) the silhouette.
        rotation: World to camera, (3, 3).
        known: The body that is followed.
        standing: How tall the person stands; None: as tall as is expected, or as is seen.
        method: How to fit.
    """
    assert report.box is not None
    stature_px, expected = float(report.box.bottom + 1 - report.box.top), None
    if known is not None:
        stature_px = known.scale_px_per_m * stature(known.bdp)
        view = view_at(rotation, known.scale_px_per_m, known.root_px)
        body, pose = body_vector(known.bdp), np.array(known.pose)
        expected = stick_fit.expected(body, pose, view, stature_px)
    if standing is not None:
        stature_px = standing.at(report.box.bottom + 1)
    try:
        fitted = stick_fit.fit(mask, expected, stature_px, method)
    except stick_fit.NoFit:
        return report
    return msgspec.structs.replace(report, fit=stick_fit.fit_of(fitted), score=fitted.score)
