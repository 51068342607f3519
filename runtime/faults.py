"""Errors in two classes: those that a user can cure, and faults of the program."""

import errno
import tempfile
import traceback
from collections.abc import Mapping
from typing import Final

from common.npz_file import Facts
from common.packages import PACKAGES
from runtime.terminal import counted

FULL: Final = (errno.ENOSPC, errno.EDQUOT)
"""The message for a full disk, wherever it occurs."""

FAULTY: Final = 1
"""Exit code of a fault."""
MENDABLE: Final = 2
"""Exit code of an error that a user can cure."""

UNFOLLOWED: Final = 3
"""Exit code of a run whose results are written but hardly believable."""
HALF: Final = 0.5
SHOWN: Final = 60
"""Letters of a name that is too long which are shown."""


class Unfollowed(RuntimeError):
    """Clips that were not read to their end, or whose bodies are mostly not believed; results
    are written."""


class Fault(RuntimeError):
    """A fault in another process; the text says where its traceback is."""


def told(error: Exception) -> str:
    """The error in one line; for a fault it names the file with the traceback."""
    if isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG:
        return f"the name {str(error.filename)[:SHOWN]!r}... is too long: use a shorter one"
    if _is_for_the_user(error) or isinstance(error, Fault):
        return str(error)
    with tempfile.NamedTemporaryFile(
        "w", prefix="tritrack-fault-", suffix=".txt", delete=False
    ) as kept:
        kept.writelines(traceback.format_exception(error))
    name, text = type(error).__name__, " ".join(str(error).split())
    return f"a fault of tritrack itself ({name}: {text}): please report {kept.name}"


def code_of(error: Exception) -> int:
    """The exit code of a process that ends with this error."""
    if isinstance(error, Unfollowed):
        return UNFOLLOWED
    return FAULTY if isinstance(error, Fault) or not _is_for_the_user(error) else MENDABLE


def refuse_unfollowed(clips: Mapping[str, Facts]) -> None:
    """End a run with a code of its own where a clip's person is mostly not followed.

    Raises:
        Unfollowed: When one could not be read to its end, is followed in less than half of its
            frames with a person, or shows no person.
    """
    _refuse_unread(clips)
    shares = {name: facts["followed"] for name, facts in clips.items()}
    poor = {name: share or 0.0 for name, share in shares.items() if (share or 0.0) < HALF}
    if poor:
        worst = min(poor, key=lambda name: poor[name])
        found = "nobody was found" if shares[worst] is None else f"{poor[worst]:.0%}"
        raise Unfollowed(
            f"in {len(poor)} of {counted(len(clips), 'clip')} the body is followed in less than "
            f"half of the frames ({worst}: {found}): do what the warnings say, name an empty "
            "picture of the room, or light it better"
        )


def _refuse_unread(clips: Mapping[str, Facts]) -> None:
    lost = {
        path: read for facts in clips.values() for path, read in facts.get("unread", {}).items()
    }
    if lost:
        parts = ", ".join(f"{path}: {read['read']} of {read['of']}" for path, read in lost.items())
        raise Unfollowed(
            f"not all frames could be read ({parts}): the results are of those that could; copy or "
            "record the video again"
        )


def _is_for_the_user(error: Exception) -> bool:
    """Whether it is an exception class of ours, a full disk or too long a name; anything else is a
    fault."""
    if isinstance(error, OSError) and error.errno in (*FULL, errno.ENAMETOOLONG):
        return True
    return type(error).__module__.split(".")[0] in PACKAGES
