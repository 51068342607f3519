"""The images of an instant, by camera, as a program passes them."""

from collections.abc import Mapping, Sequence

import numpy as np

from common.bus.messages import ViewerNumber
from common.video.clip_facts import ClipView
from common.video.pictures import Image
from common.video.reduction import reduced

Images = Image | Sequence[Image | None] | Mapping[str, Image | None]
"""One camera's image, all in order, or by camera name; None: it has none now."""


def by_viewer(
    images: Images | None, numbers: Mapping[str, ViewerNumber]
) -> dict[ViewerNumber, Image]:
    """The images that exist, by viewer number.

    Args:
        images: As passed.
        numbers: Viewer number of each camera, in the order of the images.

    Raises:
        ValueError: When one is no image, or they do not match these cameras.
    """
    listed = _listed(images, numbers)
    if len(listed) != len(numbers):
        raise ValueError(
            f"{len(listed)} images for {len(numbers)} cameras ({', '.join(numbers)}): give one of "
            "each, or None; cameras=[...] names those that give any"
        )
    named = [each for each in zip(numbers, listed, strict=True) if each[1] is not None]
    return {numbers[name]: _image(name, image) for name, image in named}


def picture_of(image: Image, view: ClipView) -> Image:
    """The working copy of an image: a program may read its next image into the same array.

    It is contiguous and writable, whatever the image is: for another kind of array every compiled
    pass would be compiled again.
    """
    return np.array(reduced(image, view.size, view.quarters), np.uint8, order="C")


def _listed(images: Images | None, numbers: Mapping[str, ViewerNumber]) -> Sequence[object]:
    if images is None or isinstance(images, np.ndarray):
        return [images]
    if isinstance(images, Mapping):
        unknown = [name for name in images if name not in numbers]
        if unknown:
            known = ", ".join(numbers)
            raise ValueError(f"there is no camera {unknown[0]!r}: there is {known}")
        return [images.get(name) for name in numbers]
    if isinstance(images, str) or not isinstance(images, Sequence):
        raise ValueError(
            f"images are one array, a list of them or a dict by camera, got {_kind(images)}"
        )
    return images


def _image(name: str, image: object) -> Image:
    if not isinstance(image, np.ndarray):
        raise ValueError(f"camera {name}: an image is an array (H, W, 3) of uint8, {_got(image)}")
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] != 3 or not image.size:
        raise ValueError(
            f"camera {name}: an image is an array (H, W, 3) of uint8, blue, green, red; this is "
            f"{image.shape} of {image.dtype}"
        )
    return image


def _got(image: object) -> str:
    if isinstance(image, tuple) and len(image) == 2 and isinstance(image[0], bool):
        return "got what read() of a video gives: take the second of both, read()[1]"
    return f"got {_kind(image)}"


def _kind(thing: object) -> str:
    return type(thing).__name__
