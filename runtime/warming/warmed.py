"""The state that a run's parts are forked from: modules imported, compiled code loaded.

A platform's launcher imports this module, and the import does the work.
"""

from typing import Final

from common.cache_folder import mark_of_all
from common.platform.platform import Job
from common.platform.platforms import platform
from common.video import decoder
from integrator import __main__ as integrator_process
from recognizer import __main__ as recognizer_process
from runtime.warming.parts_warmup import compile_all, warm_up
from viewer import __main__ as viewer_process

PROCESSES: Final = (viewer_process, integrator_process, recognizer_process, decoder)


def compile_first() -> None:
    """Compile what is not compiled yet: a part that had to compile during a run would stall.

    In a separate process, because compilation starts threads.
    """
    if mark_of_all().exists():
        return
    platform().start(Job("first run", compile_all, (), nests=True)).worker.join()


compile_first()
warm_up()
