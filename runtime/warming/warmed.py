"""What the parts of a run are forked from: everything imported, compiled code loaded.

Imported where a platform's launcher loads what parts need, and the work is done as it is imported.
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
    """Let all be compiled that is not: a part that met it in the midst of a run would stand still.

    In a process of its own, as it begins threads.
    """
    if mark_of_all().exists():
        return
    platform().start(Job("first run", compile_all, (), nests=True)).worker.join()


compile_first()
warm_up()
