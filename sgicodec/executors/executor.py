"""What an executor of tiles does, and what becomes of jobs that fail."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

from sgicodec.cuda.choice import NamedDevice
from sgicodec.device import Device
from sgicodec.errors import SgiError, TileFailedError

Job = TypeVar("Job")
Result = TypeVar("Result")

MIB = 1 << 20

_TRIES = 2
"""How often a job is tried that fails for a reason which may be the machine's."""


@dataclass(frozen=True)
class Memory:
    """Bytes at the peak: of the process that reads and writes, of each worker, and what the two share where they are
    one process.
    """

    main: int
    worker: int
    shared: int = 0

    def total(self, workers: int) -> int:
        """Of all processes together. A single worker is the main process itself."""
        return self.main + workers * self.worker - (self.shared if workers == 1 else 0)


@dataclass(frozen=True)
class Failure:
    """What became of a job that raised. final: another try would end the same way."""

    message: str
    final: bool

    @classmethod
    def of(cls, error: Exception) -> Failure:
        """An error of the input's is final; others may be the machine's."""
        return cls(str(error) or type(error).__name__, isinstance(error, SgiError))


class Tries:
    """How often jobs have failed in a run."""

    def __init__(self) -> None:
        self._failed = Counter[int]()

    def failed(self, number: int, failure: Failure, cause: Exception | None = None) -> None:
        """Counts a failure. Raises TileFailedError unless the job is to be tried again."""
        self._failed[number] += 1
        if failure.final or self._failed[number] == _TRIES:
            raise TileFailedError(number, failure.message) from cause


class Executor:
    """Runs a task on the tiles of a picture: one after the other in this process. Others extend it.

    place: path or URL at which workers read the picture themselves; None if they are sent their pixels.
    """

    place: str | None = None

    @property
    def workers(self) -> int:
        """How many jobs run at once."""
        return 1

    def within(self, memory: Memory, jobs: int) -> Executor:
        """The same for n jobs: with no more workers than there are jobs, or than its memory limit allows."""
        return self

    def device(self, whole: Device, jobs: int) -> Device | NamedDevice:
        """What computes each of n jobs, if `whole` computes all of them; asked where a job is done."""
        return whole

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
    ) -> Iterator[tuple[int, Result]]:
        """Results of task(number, job_of(number)) as they come, in any order.

        `job_of` runs in this process, at the moment when a worker can begin, so that few jobs are in memory at once.
        Raises TileFailedError for a job that failed twice, or once for what is the input's.
        """
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
