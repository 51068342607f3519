"""What a warmed process begins by, read where it is said: to import it would begin to fork."""

import re
from importlib.util import find_spec
from pathlib import Path

from common.packages import ROOT

SOURCE = (ROOT / "runtime" / "forking" / "warmed.py").read_text()


def test_what_is_run_first_is_a_program_of_ours_that_compiles() -> None:
    named = re.search(r'^FIRST_RUN: Final = "(\S+)"$', SOURCE, re.MULTILINE)
    assert named is not None
    found = find_spec(named[1])
    assert found is not None
    assert found.origin is not None
    assert "compile_all()" in Path(found.origin).read_text()
