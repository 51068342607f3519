"""The child process that finds rigs.

Each line is a Job or an OddJob, as base64 of its MessagePack; each answer is preceded by its
length. It runs at low priority: it gets a third of the run's processes' time where there is not
enough.
"""

import base64
from typing import Final

import msgspec

from common.platform.platform import Asker
from common.platform.platforms import platform

POLITE: Final = 5


def main(asker: Asker) -> None:
    """Answer until the asker is gone."""
    platform().give_way(POLITE)  # also while it imports
    from integrator.live_rig.odd_job import OddJob, odd_solved
    from integrator.live_rig.rig_job import LENGTH, Job, solved

    for line in asker.requests:
        job = msgspec.msgpack.decode(base64.b64decode(line), type=Job | OddJob)
        found = solved(job) if isinstance(job, Job) else odd_solved(job)
        answer = msgspec.msgpack.encode(found)
        asker.answers.write(LENGTH.pack(len(answer)) + answer)
        asker.answers.flush()
