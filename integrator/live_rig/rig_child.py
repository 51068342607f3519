"""The child that finds rigs: `python -m integrator.live_rig.rig_child PIPE`.

Each line is a Job, as base64 of its MessagePack; each answer a Solved with its length before it.
It gives way to the processes of the run: a third of what they get, where there is not enough.
"""

import base64
import os
import sys
from typing import Final

import msgspec

from integrator.live_rig.rig_job import LENGTH, Job, solved

POLITE: Final = 5


def main() -> None:
    """Answer until the asker is gone."""
    os.nice(POLITE)
    with os.fdopen(int(sys.argv[1]), "wb") as answers:
        for line in sys.stdin:
            job = msgspec.msgpack.decode(base64.b64decode(line), type=Job)
            answer = msgspec.msgpack.encode(solved(job))
            answers.write(LENGTH.pack(len(answer)) + answer)
            answers.flush()


if __name__ == "__main__":
    main()
