"""What sites are forked from: what a run's parts have, and what its supervisor and metrics have.

Imported by the zygote of a service alone (`runtime/forking/zygote.py`).
"""

from contextlib import suppress
from typing import Final

from common.bus.process import settle
from runtime.forking import warmed
from runtime.offline import lockstep
from runtime.serving import site_process

LOADED: Final = [warmed, lockstep, site_process]

with suppress(ImportError):  # the metrics are an extra
    from runtime.outside import metrics_process

    LOADED.append(metrics_process)

settle()
