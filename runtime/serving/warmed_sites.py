"""What sites are forked from: what a run's parts have, and what its supervisor and metrics have.

Imported where the launcher of a service loads what its sites need.
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
