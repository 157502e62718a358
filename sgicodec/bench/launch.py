"""Runs the command in its arguments and prints its seconds, its peak memory in MiB and its seconds of processor time
("-" where unknown).

A script of its own, because a child's peak memory starts at that of the process it was forked from: launched
from the benchmark itself, every codec would seem to need what the benchmark holds.
"""

from __future__ import annotations

import subprocess
import sys
import time


def used() -> tuple[float, float] | None:
    """The largest resident size of any ended child in MiB, and the processor seconds of all; None where the system does
    not tell.
    """
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 1024  # bytes there, KiB elsewhere
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_maxrss * unit / 2**20, usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    start = time.perf_counter()
    status = subprocess.run(sys.argv[1:], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL).returncode
    seconds = time.perf_counter() - start
    print(seconds, *(used() or ("-", "-")))
    sys.exit(1 if status else 0)
