"""The child that finds rigs.

Each line is a Job, as base64 of its MessagePack; each answer a Solved with its length before it.
It gives way to the processes of the run: a third of what they get, where there is not enough.
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
    from integrator.live_rig.rig_job import LENGTH, Job, solved

    for line in asker.requests:
        job = msgspec.msgpack.decode(base64.b64decode(line), type=Job)
        answer = msgspec.msgpack.encode(solved(job))
        asker.answers.write(LENGTH.pack(len(answer)) + answer)
        asker.answers.flush()
