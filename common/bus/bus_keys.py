"""The keys of a bus: which files each part needs, and Zenoh's settings for them."""

from pathlib import Path
from typing import Any, Final, Literal, NamedTuple, get_args

from common.bus.messages import ViewerNumber

Part = Literal[
    "integrator",
    "viewer1",
    "viewer2",
    "viewer3",
    "viewer4",
    "viewer5",
    "viewer6",
    "viewer7",
    "viewer8",
    "recognizer",
    "animator",
    "supervisor",
    "metrics",
    "client",
]
"""A part that connects to a bus: the common name of its certificate. A client only listens."""

PARTS: Final[tuple[Part, ...]] = get_args(Part)
HUB: Final[Part] = "integrator"
"""The part that all others connect to: its certificate is a server's."""
VIEWERS: Final[dict[ViewerNumber, Part]] = dict(
    enumerate((part for part in PARTS if part.startswith("viewer")), start=1)
)
PARTS_OF_EVERY_RUN: Final = tuple(
    part for part in PARTS if part not in ("client", *VIEWERS.values())
)
"""Parts of a run beside its viewers."""
AUTHORITY: Final = "ca.pem"
"""The certificate that signed all others; every host of a run needs it."""


class KeysError(RuntimeError):
    """Keys that cannot be used or made: the text names the file and the cure."""


class KeyPair(NamedTuple):
    """The two files of a part."""

    certificate: Path
    key: Path
    """Private: mode 0600, readable by the part alone."""


def pair_of(folder: Path, part: Part) -> KeyPair:
    """The paths of a part's files."""
    return KeyPair(folder / f"{part}.pem", folder / f"{part}.key")


def refuse_missing(folder: Path, part: Part) -> None:
    """Refuse keys with a missing file.

    Raises:
        KeysError: When a file does not exist, or this user may not read it.
    """
    for path in (folder / AUTHORITY, *pair_of(folder, part)):
        try:
            path.open("rb").close()
        except OSError as error:
            why = (error.strerror or str(error)).lower()
            raise KeysError(
                f"cannot read {path}: {why}; copy it from where the keys were made, or make all "
                "anew: tritrack keys FOLDER"
            ) from error


def tls_of(folder: Path, part: Part) -> dict[str, Any]:
    """Zenoh's settings for a part's keys (`transport/link/tls`); each side checks the other's.

    Raises:
        KeysError: When a file is missing.
    """
    refuse_missing(folder, part)
    own, side = pair_of(folder, part), "listen" if part == HUB else "connect"
    return {
        "root_ca_certificate": str(folder / AUTHORITY),
        f"{side}_certificate": str(own.certificate),
        f"{side}_private_key": str(own.key),
        "enable_mtls": True,
        "verify_name_on_connect": True,
    }
