"""The main job on a made-up person: what `make demo` shows."""

import tempfile
from pathlib import Path
from typing import Any, Final

import msgspec
from rich.console import Console

from common.config import PageSettings, Settings
from synth.write import write_set
from tritrack.session import free_settings, live

PERFORMER_SEED: Final = 90_001
"""Of a person that no model was trained on: the one in the package knows persons 1200 to 1211."""
POSTURE: Final = "raise_right_lateral"
SIZE: Final = (320, 240)


class DemoFailed(RuntimeError):
    """The demo ran, and was wrong; the text says what it saw."""


def run_demo(out: Path, page: bool, console: Console) -> dict[str, Any]:
    """Render a clip, run the whole system on it, and check what it says.

    Raises:
        DemoFailed: When another posture was named than was performed.
    """
    with tempfile.TemporaryDirectory(prefix="tritrack-demo-") as folder:
        console.print(f"making a person who performs {POSTURE} ...")
        clip = write_set(Path(folder), "postures", 1, 1, PERFORMER_SEED, SIZE, (POSTURE,))[0]
        settings = free_settings(Settings(clip=str(clip), pictures=True))
        if not page:
            settings = msgspec.structs.replace(settings, page=PageSettings(port=0))
        facts = live(settings, out, console)
    if facts["posture"] != POSTURE:
        raise DemoFailed(f"performed {POSTURE}, named {facts['posture'] or 'nothing'}")
    return facts
