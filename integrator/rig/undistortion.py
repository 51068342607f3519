"""Removal of lens distortion: the kernel and the network expect pictures without it."""

from functools import lru_cache
from itertools import islice

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.observation import Landmarks, Observation, Pixel, Search
from common.bus.instant import Instant
from common.bus.messages import View
from common.raster.silhouette_report import box_of, is_cut, pack, unpack
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig


def undistorted_rig(rig: Rig) -> Rig:
    """The cameras without distortion."""
    if not any(any(camera.distortion) for camera in rig.cameras):
        return rig
    cameras = tuple(undistorted_camera(camera) for camera in rig.cameras)
    return msgspec.structs.replace(rig, cameras=cameras, distortion=())


def undistorted_camera(camera: Camera) -> Camera:
    """The camera without distortion."""
    return msgspec.structs.replace(camera, distortion=()) if any(camera.distortion) else camera


def undistorted_instant(rig: Rig | None, instant: Instant) -> Instant:
    """The views of an instant as undistorted cameras would give them; those of unknown cameras
    unchanged."""
    if rig is None:
        return instant
    views = tuple(
        None if view is None else undistorted_view(view, camera)
        for view, camera in zip(instant.views, rig.cameras, strict=True)
    )
    return Instant(views)


def undistorted_view(view: View, camera: Camera) -> View:
    """A view with its people, without distortion."""
    if not view.people or not any(camera.distortion):
        return view
    people = tuple(undistorted_observation(each, camera) for each in view.people)
    return msgspec.structs.replace(view, people=people)


def undistorted_observation(seen: Observation, camera: Camera) -> Observation:
    """A person with silhouette, box, area, navel and landmarks without distortion.

    What the lens shows beyond the border of that picture is cut off; a person of whom nothing would
    be left is not changed, nor is anything under a lens without distortion.
    """
    if not any(camera.distortion):
        return seen
    mask = undistorted(unpack(seen), camera)
    box = box_of(mask)
    if box is None:
        return seen
    return msgspec.structs.replace(
        seen,
        silhouette=pack(mask),
        box=box,
        area_px=int(mask.sum()),
        cut=seen.cut or is_cut(box, mask.shape),
        search=_undistorted_search(seen.search, camera),
        landmarks=_undistorted_landmarks(seen.landmarks, camera),
    )


def _undistorted_search(search: Search | None, camera: Camera) -> Search | None:
    if search is None:
        return None
    return msgspec.structs.replace(search, root_px=_undistorted_px(search.root_px, camera))


def _undistorted_px(place: Pixel, camera: Camera) -> Pixel:
    K = np.array(camera.K)
    u, v = cv2.undistortPoints(np.array([[place]]), K, np.array(camera.distortion), P=K)[0, 0]
    return float(u), float(v)


def _undistorted_landmarks(shown: Landmarks | None, camera: Camera) -> Landmarks | None:
    if shown is None:
        return None
    K, kinds = np.array(camera.K), ("joints_px", "second_px", "extremities_px")
    lengths = [len(getattr(shown, kind)) for kind in kinds]
    places_px = np.array([[place for kind in kinds for place in getattr(shown, kind)]])
    straight = cv2.undistortPoints(places_px, K, np.array(camera.distortion), P=K)[:, 0]
    places = iter([(u, v) for u, v in straight.tolist()])
    told = {kind: tuple(islice(places, n)) for kind, n in zip(kinds, lengths, strict=True)}
    return msgspec.structs.replace(shown, **told)


def undistorted(mask: Mask, camera: Camera) -> Mask:
    """A silhouette (H, W) as the camera would show it without distortion."""
    if not any(camera.distortion):
        return mask
    across, down = _maps(camera, mask.shape[1], mask.shape[0])
    return np.asarray(cv2.remap(mask.view(np.uint8), across, down, cv2.INTER_NEAREST) > 0)


@lru_cache(maxsize=4)
def _maps(
    camera: Camera, width: int, height: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Place in the distorted picture of each undistorted pixel; OpenCV's coordinates begin in a
    pixel's middle."""
    K = np.array(camera.K)
    K[:2, 2] -= 0.5
    across, down = cv2.initUndistortRectifyMap(
        K, np.array(camera.distortion), np.eye(3), K, (width, height), cv2.CV_32FC1
    )
    return np.asarray(across), np.asarray(down)
