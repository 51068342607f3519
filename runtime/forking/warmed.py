"""What the parts of a run are forked from: everything imported, compiled code loaded.

Imported by the zygote alone (`zygote.py`), and the work is done as it is imported: multiprocessing
gives its server no other moment.
"""

import os
import signal
import subprocess
import sys
from typing import Final

from common.cache_folder import mark_of_all
from common.child.parent_death import end_with
from common.video import decoder
from integrator import __main__ as integrator_process
from recognizer import __main__ as recognizer_process
from runtime.forking.parts_warmup import warm_up
from viewer import __main__ as viewer_process

PID = os.getpid()
"""Of who forks the parts."""
FIRST_RUN: Final = "tritrack.first_run"
PROCESSES: Final = (viewer_process, integrator_process, recognizer_process, decoder)


def compile_first() -> None:
    """Let all be compiled that is not: a part that met it in the midst of a run would stand still.

    In a process of its own, as it begins threads; it ends with this one, and hears no Ctrl-C.
    """
    if not mark_of_all().exists():
        command = [sys.executable, "-P", "-m", FIRST_RUN, str(os.getpid())]
        subprocess.run(command, stdout=subprocess.DEVNULL, start_new_session=True, check=False)


def begin(starter: int) -> None:
    """Fork from now on, and end with who started this process, by its number, not before.

    SIGTERM waits in each fork until that can heed it: said to all processes of a service, as by
    systemd, it must not end who forks, and all forks with it.
    """
    global PID  # noqa: PLW0603 - a fork that forks in its turn has it anew
    PID = os.getpid()
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    end_with(starter)


begin(os.getppid())
compile_first()
warm_up()
