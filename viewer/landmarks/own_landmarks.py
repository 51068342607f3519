"""Our own source of landmarks: a small network that looks at the working picture."""

from common.bus.messages import Landmarks
from common.video.decoding import Image
from viewer.silhouette.silhouette import Seen


def own_landmarks(picture: Image, seen: Seen) -> Landmarks | None:  # noqa: ARG001
    """What the network makes of a picture; it is not there yet and tells nothing.

    Args:
        picture: (H, W, 3) the working picture.
        seen: The outline in it.
    """
    return None
