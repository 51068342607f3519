"""A process has the name that a user looks for."""

import subprocess
import sys

import pytest


@pytest.mark.skipif(sys.platform != "linux", reason="the name is set on Linux alone")
@pytest.mark.parametrize(("name", "shown"), [("viewer 1", "viewer 1"), ("s" * 20, "s" * 15)])
def test_ps_shows_the_name(name: str, shown: str) -> None:
    code = (
        "import os, subprocess; from common.child.process_name import be_shown_as\n"
        f"be_shown_as({name!r})\n"
        "print(subprocess.check_output(['ps', '-o', 'comm=', '-p', str(os.getpid())], text=True))"
    )
    said = subprocess.check_output([sys.executable, "-c", code], text=True)
    assert said.strip() == shown
