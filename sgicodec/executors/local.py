"""What executors on this machine have in common: as many workers as there is memory for."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

from sgicodec.device import Device
from sgicodec.errors import UsageError
from sgicodec.executors.available import group_memory, machine_memory
from sgicodec.executors.executor import MIB, Executor, Memory

__all__ = ["LocalExecutor"]


class LocalExecutor(Executor, ABC):
    """An `Executor` with workers of this machine, started for each run.

    workers: at most; 0 for `default`. max_memory: bytes that they may take together at their peak.
    """

    workers = 1

    def __init__(self, workers: int, default: int, max_memory: float | None) -> None:
        if not isinstance(workers, int) or workers < 0:
            raise UsageError(f"workers {workers!r}; 0 (by the number of cores) or more")
        self.workers, self._max_memory = workers or default, max_memory

    def within(self, memory: Memory, jobs: int) -> Executor:
        """As in `Executor`; a single worker is this process. Without `max_memory`, no more than the machine, or the
        control group of this process, has memory for. Raises UsageError if `max_memory` is too low for one.
        """
        limit = self._max_memory
        has = (group_memory() or machine_memory()) if limit is None else limit
        most = min(self.workers, jobs)
        fitting = [count for count in range(1, most + 1) if has is None or memory.total(count) <= has]
        if not fitting and limit is not None:
            needed = math.ceil(memory.total(1) / MIB)
            raise UsageError(
                f"one worker takes about {needed} MiB, more than --max-memory; a smaller --tile takes less"
            )
        count = max(fitting, default=1)
        return Executor() if count == 1 else self._with(count)

    @abstractmethod
    def _with(self, workers: int) -> Executor:
        """The same with fewer workers."""

    def device(self, whole: Device, jobs: int) -> Device:
        """The threads are shared among the workers."""
        return whole.shared_among(min(self.workers, jobs))
