"""What sites are forked from: it has all that a site's processes import, and no thread."""

import subprocess
import sys

import pytest

LOOK = """
import os, sys
from runtime.serving import warmed_sites
wanted = {"runtime.live.session", "runtime.offline.lockstep", "viewer.track", "integrator.merge"}
print(sorted(wanted - set(sys.modules)), len(os.listdir("/proc/self/task")))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="sites are forked on Linux alone")
def test_all_that_a_site_imports_is_there_and_no_thread_that_its_forks_would_lack() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOOK], capture_output=True, text=True, check=True, timeout=300.0
    )
    assert done.stdout == "[] 1\n"
