"""Memory of a command and all its processes: python -m sgicodec.bench.peak COMMAND… (Linux)."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

__all__ = ["family", "main", "share", "together"]

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


def share(pid: int) -> int:
    """Proportional set size in KiB: what processes share is counted once; 0 for one that has ended."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)


def together(pid: int) -> float:
    """MiB of a process and all that it started; 0 while there is but one, whose peak the system knows."""
    pids = list(family(pid))
    return sum(map(share, pids)) / 1024 if len(pids) > 1 else 0.0


def main(command: list[str]) -> int:
    """Runs the command, prints its peak in MiB and its seconds; returns its exit status."""
    start, peak = time.monotonic(), 0
    process = subprocess.Popen(command)
    while process.poll() is None:
        peak = max(peak, sum(map(share, family(process.pid))))
        time.sleep(_EVERY_SECONDS)
    print(f"peak {peak / 1024:.0f} MiB, {time.monotonic() - start:.1f} s", file=sys.stderr)
    return process.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
