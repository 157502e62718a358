"""What computes: threads and instruction set of the processor."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace

from sgicodec.errors import UsageError

__all__ = ["ALL_CORES", "ONE_THREAD", "Device"]


@dataclass(frozen=True)
class Device:
    """threads: 0 for one per core. isa: auto, avx512, avx2 or portable, a ValueError where this machine lacks it.

    Neither changes a symbol; pixels differ between instruction sets by less than a level of eight bits. A program makes
    one where it begins and hands it down to whatever computes.
    """

    threads: int = 0
    isa: str = "auto"

    def __post_init__(self) -> None:
        if self.threads < 0:
            raise UsageError(f"threads {self.threads}; 0 (all cores) or more")

    @property
    def cores(self) -> int:
        """How many threads that is."""
        return self.threads or os.cpu_count() or 1

    def with_threads(self, threads: int) -> Device:
        """The same with another number of threads."""
        return replace(self, threads=threads)


ALL_CORES = Device()
ONE_THREAD = Device(threads=1)
