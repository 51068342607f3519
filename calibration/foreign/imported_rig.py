"""A calibration of another program as ours, by the kind of its file."""

from pathlib import Path

from calibration.foreign.foreign_camera import ForeignCamera, Up, our_rig
from calibration.foreign.opencv_rig import read_opencv
from calibration.foreign.qualisys_rig import read_qualisys
from calibration.foreign.toml_rig import read_toml
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError


def imported_rig(path: Path, wanted: tuple[str, ...] = (), up: Up | None = None) -> Rig:
    """Two or more cameras of a file.

    Args:
        path: In TOML, the text of Qualisys, or what OpenCV's FileStorage writes.
        wanted: Names of the cameras to keep, in this order; all when empty.
        up: Which axis of its world is up; None: taken from its pictures.

    Raises:
        CalibrationError: When the file is of no kind that is known, cannot be read, has no such
            camera, or its cameras form no rig.
    """
    readers = {".toml": read_toml, ".txt": read_qualisys, ".xml": _read_xml}
    readers |= {".yml": read_opencv, ".yaml": read_opencv}
    if path.suffix not in readers:
        raise CalibrationError(
            f"{path}: known are .toml, .qca.txt and OpenCV's .yml and .xml, not {path.suffix!r}"
        )
    cameras = readers[path.suffix](path)
    by_name = {camera.name: camera for camera in cameras}
    missing = [name for name in wanted if name not in by_name]
    if missing:
        raise CalibrationError(f"{path} has no camera {missing[0]!r}; it has {', '.join(by_name)}")
    return our_rig([by_name[name] for name in wanted] if wanted else cameras, str(path), up)


def _read_xml(path: Path) -> list[ForeignCamera]:
    """OpenCV's, or that of Qualisys."""
    try:
        with path.open("rb") as file:
            ours = b"<opencv_storage" in file.read(1000)
    except OSError as error:
        raise CalibrationError(f"cannot read the calibration {path}: {error.strerror}") from error
    return read_opencv(path) if ours else read_qualisys(path)
