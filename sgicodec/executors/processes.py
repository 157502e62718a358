"""Tiles over several processes of this machine. One that dies is replaced; its tile gets a second try."""

from __future__ import annotations

import contextlib
import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Lock
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from sgicodec.executors.executor import Failure, Tries
from sgicodec.executors.local import LocalExecutor
from sgicodec.executors.peak import Peaks, own_peak

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

__all__ = ["ProcessExecutor"]

Job = TypeVar("Job")
Result = TypeVar("Result")


class ProcessExecutor(LocalExecutor):
    """An `Executor` with worker processes of this machine, started for each run.

    workers: at most; 0 for one per core. peaks: where they tell what they took.
    """

    _threads = 1
    """Jobs that each process does at once."""

    def __init__(self, workers: int = 0, max_memory: float | None = None, peaks: Peaks | None = None) -> None:
        super().__init__(workers, os.cpu_count() or 1, max_memory)
        self.peaks = peaks or Peaks()

    def _with(self, workers: int) -> ProcessExecutor:
        return ProcessExecutor(workers, self._max_memory, self.peaks)

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
    ) -> Iterator[tuple[int, Result]]:
        """As in `Executor`. `task`, jobs and results are pickled."""
        numbers = list(numbers)
        self.peaks.begin()
        pool = _Pool(task, self._environments(len(numbers)), self.peaks, self._threads)
        with contextlib.closing(pool):
            yield from pool.run(numbers, job_of)

    def _environments(self, jobs: int) -> list[dict[str, str]]:
        """What each process for so many jobs has in its environment besides."""
        return [{}] * min(self.workers, jobs)


@dataclass
class _Worker:
    """A process and the tiles that are its. ready: whether it can begin, or has begun."""

    process: BaseProcess
    pipe: Connection
    tiles: set[int] = field(default_factory=set)
    ready: bool = False


class _Pool(Generic[Job, Result]):
    def __init__(
        self,
        task: Callable[[int, Job], Result],
        environments: list[dict[str, str]],
        peaks: Peaks,
        threads: int,
    ) -> None:
        from multiprocessing import get_context

        self._task, self._context = task, get_context("spawn")
        self._peaks, self._threads, self._environments = peaks, threads, environments
        self._workers = [self._start(number) for number in range(len(environments))]

    def _start(self, number: int) -> _Worker:
        here, there = self._context.Pipe()
        given = there, self._task, self._threads, self._environments[number]
        process = self._context.Process(target=_work, args=given, daemon=True)
        process.start()
        there.close()
        return _Worker(process, here)

    def run(self, numbers: Iterable[int], job_of: Callable[[int], Job]) -> Iterator[tuple[int, Result]]:
        from multiprocessing.connection import wait

        waiting, tries = deque(numbers), Tries()
        while waiting or any(worker.tiles for worker in self._workers):
            self._hand_out(waiting, job_of)
            busy = {worker.pipe: worker for worker in self._workers if worker.tiles}
            for pipe in wait(list(busy)):
                for number, outcome in self._outcomes(busy[pipe], job_of):  # type: ignore[index]
                    if not isinstance(outcome, Failure):
                        yield number, outcome
                        continue
                    tries.failed(number, outcome)
                    waiting.appendleft(number)

    def _hand_out(self, waiting: deque[int], job_of: Callable[[int], Job]) -> None:
        """Gives tiles to whoever can take one, to those that have fewest first."""
        while waiting:
            worker = min(self._workers, key=lambda worker: len(worker.tiles))
            if len(worker.tiles) == self._threads:
                return
            number = waiting.popleft()
            worker.tiles.add(number)
            if worker.ready:
                self._send(worker, number, job_of)

    def _send(self, worker: _Worker, number: int, job_of: Callable[[int], Job]) -> None:
        job = job_of(number)
        with contextlib.suppress(OSError):  # it died while it was idle: the pipe reports it to the waiting reader
            worker.pipe.send((number, job))

    def _outcomes(self, worker: _Worker, job_of: Callable[[int], Job]) -> list[tuple[int, Result | Failure]]:
        """What a worker has to say: that it is ready, what became of a tile, or of all of its tiles where it died."""
        place = self._workers.index(worker)
        try:
            peak, number, outcome = worker.pipe.recv()
        except (EOFError, OSError):
            worker.process.join()
            failure = Failure(f"its process ended with status {worker.process.exitcode}", False)
            worker.pipe.close()
            self._workers[place] = self._start(place)
            return [(number, failure) for number in sorted(worker.tiles, reverse=True)]
        self._peaks.add(place, peak)
        if number is None:
            worker.ready = True
            for number in sorted(worker.tiles):
                self._send(worker, number, job_of)
            return []
        worker.tiles.remove(number)
        return [(number, outcome)]

    def close(self) -> None:
        """Ends all processes, whatever they are doing."""
        for worker in self._workers:
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join()
            worker.pipe.close()


def _work(
    pipe: Connection,
    task: Callable[[int, Any], Any],
    threads: int,
    environment: dict[str, str],
) -> None:
    """The life of a worker. It leaves Ctrl-C to the process that started it, whose end ends it too."""
    from sgicodec._native import keep_freed_memory

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.update(environment)
    keep_freed_memory()
    turn = Lock()

    def tell(number: int | None, outcome: object) -> None:
        with turn, contextlib.suppress(OSError):  # nobody listens any more: the pipe ends
            pipe.send((own_peak(), number, outcome))

    def attempt(number: int, job: Any) -> None:
        try:
            outcome = task(number, job)
        except Exception as error:
            outcome = Failure.of(error)
        del job
        tell(number, outcome)

    tell(None, None)
    with ThreadPoolExecutor(threads) as pool:
        while True:
            try:
                given = pipe.recv()
            except (EOFError, OSError):
                return
            if threads > 1:
                pool.submit(attempt, *given)
            else:
                attempt(*given)
            del given
