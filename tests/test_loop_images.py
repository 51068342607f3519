"""Images of a loop of one's own: as they are handed over, and as they are worked on."""

import numpy as np

from common.video.clip_facts import ClipView
from common.video.pictures import Image
from runtime.steps.loop_images import picture_of


def test_an_image_may_lie_in_memory_in_any_way_and_is_not_written() -> None:
    """Compiled passes see the same kind of array always: they are not compiled anew."""
    image, view = (
        np.random.default_rng(1).integers(0, 256, (120, 160, 3), np.uint8),
        ClipView(1, "", (160, 120), (160, 120), 15.0, 0),
    )
    ways: list[Image] = [
        image.copy(),
        np.asfortranarray(image),
        np.repeat(image, 2, axis=1)[:, ::2],
        np.ascontiguousarray(image[..., ::-1])[..., ::-1],
    ]
    for given in ways:
        given.flags.writeable = False
        picture = picture_of(given, view)
        assert np.array_equal(picture, image)
        assert (picture.flags.c_contiguous, picture.flags.writeable) == (True, True)
        assert not np.shares_memory(picture, given)
