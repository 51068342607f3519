"""A signal ends a command with its word and its code, whenever it comes."""

import importlib
import os
import signal
import subprocess
import sys
import time

import pytest

from tritrack.stopping import Terminated, code_of_stop

WORD = "error: stopped before it was done\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("after_s", [0.1])
def test_a_command_that_starts_ends_with_its_word_and_code(
    number: signal.Signals, after_s: float
) -> None:
    """It waits for a package that is never whole: it is still being imported."""
    code = (
        "import runpy, sys, time, importlib.abc\n"
        "class Slow(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, *rest):\n"
        "        if name == 'typer':\n"
        "            print('importing', flush=True)\n"
        "            time.sleep(60)\n"
        "sys.meta_path.insert(0, Slow())\n"
        "runpy.run_module('tritrack', run_name='__main__', alter_sys=True)\n"
    )
    run = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert run.stdout is not None
    assert run.stdout.readline() == "importing\n"
    time.sleep(after_s)
    os.kill(run.pid, number)
    _, errors = run.communicate(timeout=20)
    assert (run.returncode, errors) == (128 + number, WORD)


def test_ctrl_c_and_sigterm_are_told_apart_by_their_codes() -> None:
    """As shells count them."""
    assert [code_of_stop(one) for one in (KeyboardInterrupt(), Terminated())] == [130, 143]


def test_a_program_that_imports_the_command_keeps_its_own_signals() -> None:
    before = signal.getsignal(signal.SIGTERM)
    importlib.import_module("tritrack.__main__")
    assert signal.getsignal(signal.SIGTERM) is before
