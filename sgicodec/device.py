"""What computes: threads and instruction set of the processor."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["ONE_THREAD", "Device"]


@dataclass(frozen=True)
class Device:
    """threads: 0 for one per core. isa: auto, avx512, avx2 or portable, a ValueError where this machine lacks it.

    Neither changes a symbol; pixels differ between instruction sets by less than a level of eight bits.
    """

    threads: int = 0
    isa: str = "auto"


ONE_THREAD = Device(threads=1)
