"""What a mask alone tells, held against a mask whose pixels are known."""

import msgspec
import numpy as np

from common.bus.message_codec import unpack
from common.bus.messages import Box
from common.raster.silhouette_report import silhouette_report, with_silhouette


def masks() -> tuple[np.ndarray, np.ndarray]:
    whole = np.zeros((6, 9), np.bool_)
    whole[2:5, 3:7] = True
    part = whole.copy()
    part[:, 5:] = False
    part[0, 3] = True
    return whole, part


def test_a_report_tells_what_its_mask_does() -> None:
    whole, _ = masks()
    report = silhouette_report(2, whole, 7, 0.5)
    assert (report.viewer, report.frame, report.captured_s) == (2, 7, 0.5)
    assert (report.width, report.height) == (9, 6)
    assert report.box == Box(left=3, right=6, top=2, bottom=4)
    assert (report.area_px, report.cut) == (12, False)
    assert np.array_equal(unpack(report), whole)


def test_another_silhouette_changes_what_it_tells_and_nothing_else() -> None:
    whole, part = masks()
    report = msgspec.structs.replace(silhouette_report(1, whole), score=0.8)
    found = with_silhouette(report, part)
    assert (found.area_px, found.cut, found.score) == (7, True, 0.8)
    assert np.array_equal(unpack(found), part)
    assert with_silhouette(found, whole) == report


def test_nobody_has_no_box() -> None:
    report = silhouette_report(1, np.zeros((4, 4), np.bool_))
    assert (report.box, report.area_px, report.cut) == (None, 0, False)
