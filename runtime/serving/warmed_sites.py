"""Modules that sites are forked with: those of a run's parts, of its supervisor and metrics.

The launcher of a service imports this module to load what its sites need.
"""

from contextlib import suppress
from typing import Final

from common.bus.process import settle
from runtime.offline import lockstep
from runtime.serving import site_process
from runtime.warming import warmed

LOADED: Final = [warmed, lockstep, site_process]

with suppress(ImportError):  # the metrics are an extra
    from runtime.outside import metrics_process

    LOADED.append(metrics_process)

settle()
