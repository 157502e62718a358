"""What one process measures of decoding a stream: `python _decode_cases.py STREAM THREADS` prints it as JSON.

It uses the public interface alone, so that any version of the package can run it.
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import sgicodec

RUNS, MIN_SECONDS, CLOCK_RUNS = 5, 0.1, 15


def measured(path: str, threads: int) -> dict[str, float]:
    """Least processor seconds of several runs by what was done; by the clock, the median."""
    device = sgicodec.Device(threads)

    def opened(use: Callable[[Any], object]) -> None:
        with sgicodec.open(path, device) as stream:
            use(stream)

    stream = sgicodec.open(path, device)
    stream.read()
    width, height = stream.width, stream.height
    part = width // 4, height // 4, max(1, width // 2), max(1, height // 2)
    detail = width // 3, height // 3, max(1, width // 8), max(1, height // 8)
    view = min(256, width - detail[0]), min(256, height - detail[1])
    cases: dict[str, Callable[[], object]] = {
        "open": lambda: opened(lambda fresh: fresh.shape),
        "open, whole picture": lambda: opened(lambda fresh: fresh.read()),
        "open, a detail": lambda: opened(lambda fresh: fresh.read(detail)),
        "whole picture": lambda: stream.read(),
        "half of each side": lambda: stream.read(part),
        "whole picture, halved": lambda: stream.read(scale=0.5),
        "a detail, 4 × larger": lambda: stream.read(detail, scale=4),
        "a view of 256 × 256": lambda: stream.read((detail[0], detail[1], *view)),
    }
    found = {name: _least(use) for name, use in cases.items()}
    return found | {"open, whole picture, by the clock": _by_the_clock(cases["open, whole picture"])}


def _least(use: Callable[[], object]) -> float:
    least, runs, end = float("inf"), 0, time.perf_counter() + MIN_SECONDS
    while runs < RUNS or time.perf_counter() < end:
        start = time.process_time()
        use()
        least, runs = min(least, time.process_time() - start), runs + 1
    return least


def _by_the_clock(use: Callable[[], object]) -> float:
    seconds = []
    for _ in range(CLOCK_RUNS):
        start = time.perf_counter()
        use()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


if __name__ == "__main__":
    print(json.dumps(measured(sys.argv[1], int(sys.argv[2]))))
