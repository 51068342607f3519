"""The images of an instant, by camera, as a program hands them over."""

from collections.abc import Mapping, Sequence

import numpy as np

from common.bus.messages import ViewerNumber
from common.video.pictures import Image

Images = Image | Sequence[Image | None] | Mapping[str, Image | None]
"""Of one camera, of all in their order, or by the cameras' names; None: it has none now."""


def by_viewer(
    images: Images, numbers: Mapping[str, ViewerNumber]
) -> dict[ViewerNumber, Image | None]:
    """Images by the viewers' numbers.

    Args:
        images: As they were given.
        numbers: The viewer of each camera, in the order in which images are given.

    Raises:
        ValueError: When one is no image, or they are not of these cameras.
    """
    if isinstance(images, np.ndarray):
        images = [images]
    if isinstance(images, Mapping):
        unknown = [name for name in images if name not in numbers]
        if unknown:
            known = ", ".join(numbers)
            raise ValueError(f"there is no camera {unknown[0]!r}: there is {known}")
        images = [images.get(name) for name in numbers]
    if len(images) != len(numbers):
        raise ValueError(
            f"{len(images)} images for {len(numbers)} cameras ({', '.join(numbers)}): give one of "
            "each, or None; cameras=(...) names those that give any"
        )
    for name, image in zip(numbers, images, strict=True):
        _refuse_no_image(name, image)
    return dict(zip(numbers.values(), images, strict=True))


def _refuse_no_image(name: str, image: object) -> None:
    if image is None:
        return
    if not isinstance(image, np.ndarray) or image.dtype != np.uint8 or image.ndim != 3:
        raise ValueError(f"camera {name}: an image is an array (H, W, 3) of uint8")
    if image.shape[2] != 3 or not image.size:
        raise ValueError(f"camera {name}: an image has three colours, this is {image.shape}")
