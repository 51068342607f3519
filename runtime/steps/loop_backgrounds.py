"""The backgrounds of a program's own loop: from pictures of the empty room, or its first images."""

from collections.abc import Mapping

from common.bus.messages import ViewerNumber
from common.video.clip_facts import Clip, ClipView
from common.video.clips import SAME_ASPECT
from common.video.pictures import Image
from runtime.steps.loop_images import Images, by_viewer, picture_of

Plates = Mapping[ViewerNumber, Image]
Learns = Mapping[ViewerNumber, tuple[Image, ...]]
"""Pictures of the empty room, by camera, at the working size."""


def plates_of(background: Images, numbers: Mapping[str, ViewerNumber]) -> Plates:
    """Copied pictures of the empty room, one per camera.

    Raises:
        ValueError: When a camera has none, or one is no image.
    """
    plates = by_viewer(background, numbers)
    missing = [name for name, number in numbers.items() if number not in plates]
    if missing:
        raise ValueError(
            f"camera {missing[0]} has no background: give one of each camera "
            "(cv2.imread gives None where it can read no picture)"
        )
    return {number: plate.copy() for number, plate in plates.items()}


def empty_of(plates: Plates, clip: Clip) -> Learns:
    """These pictures at the working size.

    Raises:
        ValueError: When one has another shape than the images of its camera.
    """
    for view in clip.views:
        plate = plates[view.number]
        aspect = plate.shape[1] * view.source_size[1] / (plate.shape[0] * view.source_size[0])
        if abs(aspect - 1.0) > SAME_ASPECT:
            raise ValueError(
                f"the background of camera {view.source} is of another shape than its images: "
                "take an empty image of the same camera, uncropped"
            )
    return {view.number: (picture_of(plates[view.number], view),) for view in clip.views}


def is_enough(empty: tuple[Image, ...], view: ClipView, empty_s: float) -> bool:
    """Whether a camera has shown the empty room for long enough."""
    return len(empty) >= view.frames_in(empty_s)
