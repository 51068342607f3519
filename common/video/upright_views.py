"""A clip's views with upright pictures, however its cameras are rolled."""

import msgspec

from common.rig.camera import Camera, Rig
from common.rig.rig_file import CalibrationError
from common.rig.upright_camera import filed_camera, upright_camera, upright_of
from common.video.clip_facts import Clip, ClipView
from common.video.clip_sources import ClipError


def upright_views(rig: Rig, views: tuple[ClipView, ...]) -> tuple[Rig, tuple[ClipView, ...]]:
    """The rig and the views with working pictures.

    Args:
        rig: A camera per view, for the files' pictures at the working size.
        views: Their pictures as stored in the files.

    Raises:
        ClipError: When the distortion of a camera cannot be turned.
    """
    views = tuple(_upright(each, view) for each, view in zip(rig.cameras, views, strict=True))
    pairs = zip(rig.cameras, views, strict=True)
    try:
        cameras = tuple(upright_camera(camera, view.upright) for camera, view in pairs)
    except CalibrationError as error:
        raise ClipError(str(error)) from error
    width, height = views[0].size
    return msgspec.structs.replace(rig, width=width, height=height, cameras=cameras), views


def filed_rig(clip: Clip) -> Rig | None:
    """A clip's rig for its files' pictures at the working size, as stored."""
    if clip.rig is None:
        return None
    pairs = zip(clip.rig.cameras, clip.views, strict=True)
    cameras = tuple(filed_camera(camera, view.upright) for camera, view in pairs)
    width, height = clip.views[0].filed_size
    return msgspec.structs.replace(clip.rig, width=width, height=height, cameras=cameras)


def _upright(camera: Camera, view: ClipView) -> ClipView:
    upright = upright_of(camera, view.size)
    if upright is None:
        return view
    return msgspec.structs.replace(view, size=upright.size, upright=upright)
