"""What tells that a clip opens with the empty room, held against rooms drawn here and clips."""

from pathlib import Path

import cv2
import pytest
from test_background import HEIGHT, WIDTH, passer_by, room, shot, walker

from common.video.decoding import Image
from viewer.background.background import overlaid_opening
from viewer.background.empty_opening import is_empty_opening, is_still


def test_somebody_who_runs_through_the_opening_is_no_empty_room() -> None:
    """Their median is the empty room, and would leave them unseen in those frames."""
    assert is_still(overlaid_opening([shot(room(), 2.0, n) for n in range(8)]))
    assert not is_still(overlaid_opening([shot(passer_by(n), 2.0, n) for n in range(5, 13)]))


def test_opening_is_empty_until_somebody_stands_in_it() -> None:
    clip = [shot(room(), 2.0, n) for n in range(8)] + [shot(walker(n), 2.0, n) for n in range(40)]
    assert is_empty_opening(overlaid_opening(clip[:8]), clip[::4])
    assert not is_empty_opening(overlaid_opening(clip[8:16]), clip[8::4])


@pytest.mark.parametrize("name", ["r01_t1_12_squat", "r07_t1_08_raise_both_forward_up"])
@pytest.mark.parametrize("camera", [1, 2])
def test_opening_of_the_development_clips(data_dir: Path, name: str, camera: int) -> None:
    """Frames 0-8 show the empty room; from frame 9 on somebody is there."""
    video = cv2.VideoCapture(str(data_dir / "dev" / name / f"cam{camera}.avi"))
    clip: list[Image] = []
    while (read := video.read())[0]:
        clip.append(cv2.resize(read[1], (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA))
    assert is_empty_opening(overlaid_opening(clip[:8]), clip[::4])
    assert not is_empty_opening(overlaid_opening(clip[9:17]), clip[9::4])
