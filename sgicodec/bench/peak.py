"""Runs the command in its arguments and prints its seconds, its peak memory in MiB and its seconds of processor time
("-" where unknown).

A script of its own, because a child's peak memory starts at that of the process it was forked from: launched
from the benchmark itself, every codec would seem to need what the benchmark holds. The peak is that of its largest
process, or of all that it starts together where that is more (Linux, sampled). Isolated, it imports no package.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread

_EVERY_SECONDS = 0.1


def family(pid: int) -> Iterator[int]:
    """A process and all that it started."""
    yield pid
    try:
        threads = list(Path(f"/proc/{pid}/task").iterdir())
        children = [int(child) for thread in threads for child in (thread / "children").read_text().split()]
    except OSError:
        return
    for child in children:
        yield from family(child)


def _share(pid: int) -> int:
    """Proportional set size in KiB: what processes share is counted once; 0 for one that has ended."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)


def together(pid: int) -> float:
    """MiB of a process and all that it started; 0 while there is but one, whose peak the system knows."""
    pids = list(family(pid))
    return sum(map(_share, pids)) / 1024 if len(pids) > 1 else 0.0


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


def run(command: list[str]) -> tuple[int, float]:
    """Runs a command; its exit status, and the most MiB that several of its processes held at a time, 0 for one."""
    process, ended, most = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL), Event(), 0.0

    def sample() -> None:
        nonlocal most
        while not ended.wait(_EVERY_SECONDS):
            most = max(most, together(process.pid))

    sampling = Thread(target=sample)
    sampling.start()
    status = process.wait()  # without a time limit, with which it would look but every 50 ms
    ended.set()
    sampling.join()
    return status, most


if __name__ == "__main__":
    start = time.perf_counter()
    status, most = run(sys.argv[1:])
    seconds = time.perf_counter() - start
    largest = used()
    print(seconds, *("-", "-") if largest is None else (max(largest[0], most), largest[1]))
    sys.exit(1 if status else 0)
