"""The state that a run's parts are forked from: modules imported, compiled code loaded.

A platform's launcher imports this module, and the import does the work.
"""

from typing import Final

from common.video import decoder
from integrator import __main__ as integrator_process
from recognizer import __main__ as recognizer_process
from runtime.warming.first_compilation import compile_first
from runtime.warming.parts_warmup import warm_up
from viewer import __main__ as viewer_process

PROCESSES: Final = (viewer_process, integrator_process, recognizer_process, decoder)

compile_first()
warm_up()
