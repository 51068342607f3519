"""Pictures of the empty room that a loop of one's own gives."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tritrack import Tracker

EMPTY = np.full((120, 160, 3), 90, np.uint8)


@pytest.mark.parametrize("background", [[EMPTY, None], {"cam1": EMPTY}], ids=["list", "dict"])
def test_a_picture_of_the_empty_room_that_is_missing_is_refused_at_once(
    clip: Path, background: Any
) -> None:
    with pytest.raises(ValueError, match=r"cam2 has no background: .*\(cv2\.imread gives None"):
        Tracker(clip.parent / "calibration.json", background=background)
