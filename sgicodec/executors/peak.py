"""The most memory that processes took, by their own account."""

from __future__ import annotations

import sys


def own_peak() -> int | None:
    """The largest resident size of this process in bytes; None where the system does not tell."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 1024  # bytes there, KiB elsewhere
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


class Peaks:
    """Collects the peaks of the workers of one executor after the other. bytes: of those that ran at the same time, the
    most together; what they share, such as libraries, counts for each.
    """

    def __init__(self) -> None:
        self.bytes = 0
        self._now: dict[int, int] = {}

    def begin(self) -> None:
        """Other workers come."""
        self._now = {}

    def add(self, worker: int, peak: int | None) -> None:
        """Counts what the n-th worker took so far."""
        self._now[worker] = max(peak or 0, self._now.get(worker, 0))
        self.bytes = max(self.bytes, sum(self._now.values()))
