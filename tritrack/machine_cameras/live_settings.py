"""The settings file of a live run that the page begins."""

import json
from collections.abc import Sequence
from pathlib import Path

from common.video.pictures import Source, is_recorded


def live_settings(
    sources: Sequence[Source], port: int, calibration: Path | None, pictures: bool
) -> str:
    """TOML for these cameras, in their order.

    Args:
        sources: Devices, or files that play as cameras.
        port: Of the live page.
        calibration: Its file; None: the person tells where the cameras are.
        pictures: The page may show small pictures.
    """
    lines = ["# Written by the start page.", 'size = "320x240"']
    lines += [f"pictures = {'true' if pictures else 'false'}"]
    if calibration is not None:
        lines += [f"calibration = {_text(calibration)}"]
    for number, source in enumerate(sources, 1):
        named = f"source = {_text(Path(source))}" if is_recorded(source) else f"device = {source}"
        lines += ["", f"[cameras.cam{number}]", named]
    lines += ["", "[page]", f"port = {port}", "", "[bus]", 'endpoint = "auto"', ""]
    return "\n".join(lines)


def _text(path: Path) -> str:
    """A TOML text: JSON's escapes are among TOML's."""
    return json.dumps(str(path.resolve()), ensure_ascii=False)
