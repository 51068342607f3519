"""A calibration of another program as ours, by the kind of its file."""

from pathlib import Path

from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError
from integrator.foreign_rigs.foreign_camera import our_rig
from integrator.foreign_rigs.qualisys_rig import read_qualisys
from integrator.foreign_rigs.toml_rig import read_toml


def imported_rig(path: Path, wanted: tuple[str, ...] = ()) -> Rig:
    """Two or more cameras of a file.

    Args:
        path: In TOML, or the text of Qualisys.
        wanted: Names of the cameras to keep, in this order; all when empty.

    Raises:
        CalibrationError: When the file is of no kind that is known, cannot be read, has no such
            camera, or its cameras form no rig.
    """
    readers = {".toml": read_toml, ".txt": read_qualisys, ".xml": read_qualisys}
    if path.suffix not in readers:
        raise CalibrationError(f"{path}: known are .toml and .qca.txt, not {path.suffix!r}")
    cameras = readers[path.suffix](path)
    by_name = {camera.name: camera for camera in cameras}
    missing = [name for name in wanted if name not in by_name]
    if missing:
        raise CalibrationError(f"{path} has no camera {missing[0]!r}; it has {', '.join(by_name)}")
    return our_rig([by_name[name] for name in wanted] if wanted else cameras, str(path))
