"""Tiles one after the other in this process."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from sgicodec.device import Device
from sgicodec.executors.executor import Failure, Memory, Tries

__all__ = ["SerialExecutor"]

Job = TypeVar("Job")
Result = TypeVar("Result")


class SerialExecutor:
    """An `Executor` with this process as its only worker."""

    workers = 1
    place = None

    def within(self, memory: Memory, jobs: int) -> SerialExecutor:
        """As in `Executor`."""
        return self

    def device(self, whole: Device, jobs: int) -> Device:
        """All of it."""
        return whole

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
    ) -> Iterator[tuple[int, Result]]:
        """As in `Executor`."""
        tries = Tries()
        for number in numbers:
            while True:
                try:
                    result = task(number, job_of(number))
                except Exception as error:
                    tries.failed(number, Failure.of(error), error)
                else:
                    yield number, result
                    break
