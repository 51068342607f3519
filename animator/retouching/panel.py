"""HTML of the retouching page, from templates beside the code."""

from typing import Final

from animator.scene import Colour
from animator.take import Take, doubts_at
from common.notes.notes import Notes
from common.npz_file import Facts
from common.templates import rendered

ACCENT: Final[Colour] = (62, 142, 126)


def piece(name: str, given: Facts) -> str:
    """A template of a page filled in."""
    return rendered(__package__, name, given)


def questions(take: Take, row: int, notes: Notes) -> str:
    """The frame, the decisions in it, and its open questions."""
    doubts = doubts_at(take, row, notes)
    given = {
        "frame": int(take.frame[row]),
        "posed": bool(take.posed[row]),
        "facing": spoken(str(take.orientation[row])),
        "confidence": float(take.orientation_confidence[row]),
        "doubts": [(doubt.kind, spoken(doubt.name), doubt.confidence) for doubt in doubts],
    }
    return piece("retouch_questions.html", given)


def spoken(name: str) -> str:
    """A spoken form of a name in the files: forward_left, l_upper_arm."""
    sides = {"l": "left", "r": "right"}
    first, *others = name.split("_")
    return " ".join([sides.get(first, first), *others])
