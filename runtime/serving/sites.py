"""The sites of a machine: a TOML file of names and settings."""

import os
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from common.config.config_file import full_path, load, with_full_paths
from common.config.explained import explained
from common.config.part_settings import SettingsError
from common.config.renamed_settings import in_new_words, warn_of_renamed
from common.config.settings import Settings
from common.endpoint import address_of
from common.npz_file import Facts
from runtime.live.free_ports import ports

NAME: Final = re.compile(r"\w[\w.-]*", re.ASCII)
RUNS: Final = "runs"
"""Folder beside the file for sites that name none."""
CURE: Final = (
    "give each another one (a bus may have [bus] endpoint = 'auto', a page port = 0: none)"
)


class SiteEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A site in the file."""

    name: str
    """A plain word: name of the site, and of its room where its settings name none."""
    settings: str | Settings
    """A settings file or a clip folder, or the settings themselves."""
    out: str = ""
    """Folder of its run; runs/NAME beside the file where empty."""
    together: bool = False
    """All its parts in one process: half the memory, but a crash of one ends all for a while."""

    def __post_init__(self) -> None:
        """Refuse a name that is invalid for a folder or a room."""
        if not NAME.fullmatch(self.name):
            raise ValueError(f"name must be a plain word, got {self.name!r}")


class SitesFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of a file of sites."""

    site: list[SiteEntry] = []
    metrics: str = ""
    """HOST:PORT of /metrics and /healthz for all sites together; nowhere where empty."""

    def __post_init__(self) -> None:
        """Refuse an invalid address."""
        if self.metrics:
            address_of(self.metrics)


class Site(NamedTuple):
    """One served room."""

    name: str
    settings: Settings
    out: Path
    together: bool = False


class Sites(NamedTuple):
    """All of them."""

    sites: Mapping[str, Site]
    metrics: str


def load_sites(path: Path) -> Sites:
    """Read a file of sites, and the settings that it names.

    Relative paths are resolved against the file that contains them, environment variables are
    replaced.

    Raises:
        SettingsError: When something cannot be read, is unknown or ill-typed; when two sites share
            a name, a folder or a port; when there is no site.
    """
    said = _read(path)
    if not said.site:
        raise SettingsError(f"{path} names no site: write [[site]], name = ..., settings = ...")
    _refuse_twice(path, "name", [(entry.name, entry.name) for entry in said.site])
    sites = {entry.name: _site(entry, path) for entry in said.site}
    _refuse_twice(path, "folder", [(str(s.out.resolve()), s.name) for s in sites.values()])
    _refuse_shared_ports(path, sites, said.metrics)
    return Sites(sites, said.metrics)


def files_of(path: Path) -> tuple[Path, ...]:
    """A file of sites and the settings that it names, as far as readable."""
    try:
        said = _read(path)
    except SettingsError:
        return (path,)
    named = [entry.settings for entry in said.site if isinstance(entry.settings, str)]
    return (path, *(path.parent / os.path.expandvars(name) for name in named))


def _read(path: Path) -> SitesFile:
    try:
        written = msgspec.toml.decode(path.read_bytes())
        for entry in _own_settings(written):
            warn_of_renamed(entry["settings"], str(path))
            entry["settings"] = in_new_words(entry["settings"])
        return msgspec.convert(written, SitesFile)
    except OSError as error:
        raise SettingsError(f"cannot read the sites {path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise SettingsError(f"{path} is no file of sites: name a TOML file") from error
    except msgspec.DecodeError as error:
        raise SettingsError(f"{path}: {explained(error, SitesFile)}") from error
    except SettingsError as error:
        raise SettingsError(f"{path}: {error}") from error


def _own_settings(written: Facts) -> list[Facts]:
    """Entries that hold settings themselves."""
    entries = written.get("site")
    found = entries if isinstance(entries, list) else []
    return [one for one in found if isinstance(one, dict) and isinstance(one.get("settings"), dict)]


def _site(entry: SiteEntry, path: Path) -> Site:
    try:
        given = entry.settings
        settings = (
            load(Path(full_path(given, path)))
            if isinstance(given, str)
            else with_full_paths(given, path)
        )
        out = Path(full_path(entry.out or f"{RUNS}/{entry.name}", path))
    except SettingsError as error:
        raise SettingsError(f"{path}: site {entry.name}: {error}") from error
    if settings.room == Settings().room:
        settings = msgspec.structs.replace(settings, room=entry.name)
    return Site(entry.name, settings, out, entry.together)


def _refuse_shared_ports(path: Path, sites: Mapping[str, Site], metrics: str) -> None:
    held = [(str(port), s.name) for s in sites.values() for port in ports(s.settings)]
    if metrics:
        held.append((str(address_of(metrics)[1]), "metrics"))
    _refuse_twice(path, "port", held, CURE)


def _refuse_twice(
    path: Path, what: str, held: Sequence[tuple[str, str]], cure: str = "give each its own"
) -> None:
    """Refuse sites that share something."""
    for thing, times in Counter(thing for thing, _ in held).items():
        if times > 1:
            who = ", ".join(name for own, name in held if own == thing)
            raise SettingsError(f"{path}: {times} sites have the {what} {thing} ({who}): {cure}")
