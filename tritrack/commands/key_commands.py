"""The command that makes the keys of a bus."""

from pathlib import Path
from typing import Annotated, Final

import typer

from common.bus.bus_keys import KeysError
from tritrack.commands.command_output import JsonWanted, tell
from tritrack.doctor.installation import Finding

INSTALL: Final = "pip install 'tritrack[keys]'"


def keys(
    folder: Annotated[Path, typer.Argument(help="Folder to write into; is made.")],
    host: Annotated[
        list[str] | None,
        typer.Option(help="Name or address by which others call the integrator; once for each."),
    ] = None,
    days: Annotated[int, typer.Option(min=1, max=3650, help="Days that the keys hold.")] = 365,
    force: Annotated[bool, typer.Option(help="Replace the keys that are there.")] = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Make keys for a bus that other machines reach.

    They are an authority and a certificate for each part.

    Example: tritrack keys keys --host rig.local --host 192.168.1.5
    """
    try:
        from runtime.keys.authority import make_keys
    except ImportError as error:
        raise KeysError(f"no keys without {error.name}: {INSTALL}") from error
    written = make_keys(folder, host or (), days, force=force)
    facts = {"folder": str(folder), "days": days, "files": [path.name for path in written]}
    line = f"set [bus] keys = '{folder}' and endpoint = 'tls/HOST:PORT'"
    tell(facts, json_wanted, f"{len(written)} files in {folder}: {line}")


def examined_keys(folder: Path) -> list[Finding]:
    """The doctor's findings about keys."""
    try:
        from tritrack.doctor.key_check import examine_keys
    except ImportError as error:
        return [Finding("keys", False, f"cannot be read without {error.name}", INSTALL)]
    return examine_keys(folder)
