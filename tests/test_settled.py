"""What loading took for a while is given back, and what stays is not searched again."""

import subprocess
import sys

import pytest

SCRIPT = """
import gc, psutil
from common.settled import settle
own = psutil.Process()
taken = [bytearray(2000) for _ in range(30_000)]
kept = taken[::100]
before = own.memory_info().rss
del taken
settle()
print(before - own.memory_info().rss > 40e6, gc.get_freeze_count() > 1000, len(kept))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="of glibc alone it is known how")
def test_holes_of_the_heap_are_given_back_while_something_behind_them_is_held() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], check=True, capture_output=True, text=True
    )
    assert done.stdout == "True True 300\n"
