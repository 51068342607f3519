"""The benchmark's figures as a file: benchmarks/results.json.

Run from the checkout: .venv/bin/python benchmarks/run.py [--quick]
"""

import json
import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

from rich.console import Console

from lab.bench.bench import bench, table_of

RESULTS = Path(__file__).with_name("results.json")

if __name__ == "__main__":
    result = bench(quick="--quick" in sys.argv[1:])
    RESULTS.write_text(json.dumps(result, indent=1) + "\n")
    Console().print(table_of(result))
