"""The keys of a bus: which files each part needs, and how Zenoh is told of them."""

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
"""Who speaks on a bus: the common name of a certificate. A client only listens."""

PARTS: Final[tuple[Part, ...]] = get_args(Part)
HUB: Final[Part] = "integrator"
"""All others connect to it: its certificate is a server's."""
VIEWERS: Final[dict[ViewerNumber, Part]] = dict(
    enumerate((part for part in PARTS if part.startswith("viewer")), start=1)
)
PARTS_OF_EVERY_RUN: Final = tuple(
    part for part in PARTS if part not in ("client", *list(VIEWERS.values())[2:])
)
"""Whose keys are looked for before a run starts; the viewer of a third camera looks itself."""
AUTHORITY: Final = "ca.pem"
"""The certificate that signed all others; every host of a run needs it."""


class KeysError(RuntimeError):
    """Keys that cannot be used or made: the text names the file and the cure."""


class KeyPair(NamedTuple):
    """The two files of a part."""

    certificate: Path
    key: Path
    """For the part alone: mode 0600."""


def pair_of(folder: Path, part: Part) -> KeyPair:
    """Where a part's files lie."""
    return KeyPair(folder / f"{part}.pem", folder / f"{part}.key")


def refuse_missing(folder: Path, part: Part) -> None:
    """Say which file a part lacks.

    Raises:
        KeysError: When one is not there, or is not for us to read.
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
    """What Zenoh is told of a part's keys (`transport/link/tls`); each side checks the other's.

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
