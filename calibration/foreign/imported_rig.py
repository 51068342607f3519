"""Import of another program's calibration, by the kind of its file."""

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
        path: TOML, Qualisys text, or a file of OpenCV's FileStorage.
        wanted: Names of the cameras to keep, in this order; all when empty.
        up: The up axis of its world; None: taken from its pictures.

    Raises:
        CalibrationError: When the file is of no known kind, cannot be read, lacks a wanted camera,
            or its cameras form no rig.
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
    """An OpenCV file or a Qualisys file."""
    try:
        with path.open("rb") as file:
            ours = b"<opencv_storage" in file.read(1000)
    except OSError as error:
        raise CalibrationError(f"cannot read the calibration {path}: {error.strerror}") from error
    return read_opencv(path) if ours else read_qualisys(path)
