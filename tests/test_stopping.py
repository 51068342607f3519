"""A signal ends a command with its word and its code, whenever it comes."""

import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

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


def test_signals_are_heeded_before_anything_that_takes_a_while_is_imported() -> None:
    """What Python brings itself aside: a tenth of a second after its start Ctrl-C is told well."""
    code = (
        "import sys; sys.argv = ['tritrack']; there = set(sys.modules)\n"
        "import tritrack.stopping as it; it.heed_at_once(); print(*{*sys.modules} - there)\n"
    )
    run = subprocess.run(
        [sys.executable, "-S", "-c", code], capture_output=True, text=True, check=False
    )
    slow = {"multiprocessing", "pathlib", "logging", "importlib.metadata", "socket"}
    assert not slow & set(run.stdout.split()), run.stderr
    assert "tritrack.stopping" in run.stdout, run.stderr


def test_a_process_of_a_run_that_still_imports_the_command_leaves_signals_to_its_supervisor() -> (
    None
):
    """As `multiprocessing.spawn` has it: no parent is known before the command is imported."""
    code = (
        "import sys, signal, multiprocessing\n"
        "before = signal.getsignal(signal.SIGTERM)\n"
        "sys.argv = ['bin/tritrack']; multiprocessing.current_process()._inheriting = True\n"
        "from tritrack.stopping import heed_at_once; heed_at_once()\n"
        "print(signal.getsignal(signal.SIGTERM) is before)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout == "True\n", run.stderr


@pytest.mark.slow
def test_a_live_run_that_is_refused_says_so_in_one_line(tmp_path: Path) -> None:
    """Its page's process, which is ended as it imports, has no word of its own."""
    settings = tmp_path / "settings.toml"
    settings.write_text("")
    command = tmp_path / "tritrack"
    command.write_text(
        "from tritrack.__main__ import main\nif __name__ == '__main__':\n    main()\n"
    )
    for _ in range(3):
        run = subprocess.run(
            [sys.executable, command, "live", settings, "--out", tmp_path / "run"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert run.returncode == 2
        assert len(run.stderr.splitlines()) == 1, run.stderr
