"""What a mask alone tells of a silhouette, as a viewer reports it."""

import msgspec
import numpy as np

from common.bus.message_codec import pack
from common.bus.messages import Report, ViewerNumber
from common.raster.bounds import box_of, is_cut
from common.raster.similarity import Mask


def silhouette_report(
    viewer: ViewerNumber, mask: Mask, frame: int = 0, at_s: float = 0.0
) -> Report:
    """The report of a silhouette of which no more is known.

    Args:
        viewer: Who saw it.
        mask: (H, W), empty where nobody is seen.
        frame: Of that viewer.
        at_s: When it was taken, by either clock.
    """
    height, width = mask.shape
    nothing = Report(
        frame=frame,
        captured_s=at_s,
        clock_s=at_s,
        viewer=viewer,
        width=width,
        height=height,
        silhouette=b"",
        box=None,
    )
    return with_silhouette(nothing, mask)


def with_silhouette(report: Report, mask: Mask) -> Report:
    """The report with another silhouette of the same size."""
    box = box_of(mask)
    return msgspec.structs.replace(
        report,
        silhouette=pack(mask),
        box=box,
        area_px=int(np.count_nonzero(mask)),
        cut=is_cut(box, mask.shape),
    )
