"""What is to be done that the sites which run become those that are wanted."""

from collections.abc import Mapping
from typing import NamedTuple

from runtime.serving.sites import Site


class Changes(NamedTuple):
    """First some are stopped, then others are started; one that changed is both."""

    stop: tuple[str, ...]
    start: tuple[Site, ...]


def changes(wanted: Mapping[str, Site], running: Mapping[str, Site]) -> Changes:
    """What is to be done; sites that are as they shall be are left alone.

    Args:
        wanted: By their names.
        running: By their names, as they were started.
    """
    return Changes(
        tuple(name for name, site in running.items() if wanted.get(name) != site),
        tuple(site for name, site in wanted.items() if running.get(name) != site),
    )
