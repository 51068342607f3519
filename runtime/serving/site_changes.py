"""The changes from the running sites to the wanted ones."""

from collections.abc import Mapping
from typing import NamedTuple

from runtime.serving.sites import Site


class Changes(NamedTuple):
    """Sites to stop, then sites to start; a changed site is in both."""

    stop: tuple[str, ...]
    start: tuple[Site, ...]


def changes(wanted: Mapping[str, Site], running: Mapping[str, Site]) -> Changes:
    """The changes; unchanged sites are in neither.

    Args:
        wanted: By name.
        running: By name, with the settings that they were started with.
    """
    return Changes(
        tuple(name for name, site in running.items() if wanted.get(name) != site),
        tuple(site for name, site in wanted.items() if running.get(name) != site),
    )
