"""A posture report as a self-contained page."""

from base64 import b64encode
from pathlib import Path
from typing import Final

from common.npz_file import Facts
from common.templates import rendered

PAPERS: Final = {"correct": 332, "tested": 360, "share": 332 / 360, "interval_95": (0.890, 0.946)}
"""Table 2 of the paper, all postures."""


def page_of(report: Facts, folder: Path) -> str:
    """The whole page.

    Args:
        report: What `report.json` holds.
        folder: Folder of the pictures that it names; they are embedded.

    Raises:
        OSError: When a picture cannot be read.
    """

    def picture(name: str) -> str:
        return f"data:image/png;base64,{b64encode((folder / name).read_bytes()).decode()}"

    given = {
        **{"results": report["recognizers"], "groups": report["people"]},
        **{"split": report["split"], "sweep": report.get("sweep")},
        **{"papers": PAPERS, "picture": picture},
    }
    return rendered(__package__, "posture_page.html", given)
