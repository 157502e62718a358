"""Tiles over several processes of this machine. One that dies is replaced; its tile gets a second try."""

from __future__ import annotations

import contextlib
import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from sgicodec.device import Device
from sgicodec.errors import UsageError
from sgicodec.executors.available import workers_that_fit
from sgicodec.executors.executor import Executor, Failure, Memory, Tries
from sgicodec.executors.peak import Peaks, own_peak
from sgicodec.executors.serial import SerialExecutor

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

__all__ = ["ProcessExecutor"]

Job = TypeVar("Job")
Result = TypeVar("Result")


class ProcessExecutor:
    """An `Executor` with worker processes of this machine, started for each run.

    workers: at most; 0 for one per core. max_memory: bytes that all processes together may take at their peak. peaks:
    where they tell what they took.
    """

    place = None

    def __init__(self, workers: int = 0, max_memory: float | None = None, peaks: Peaks | None = None) -> None:
        if not isinstance(workers, int) or workers < 0:
            raise UsageError(f"workers {workers!r}; 0 (one per core) or more")
        self.workers, self._max_memory = workers or os.cpu_count() or 1, max_memory
        self.peaks = peaks or Peaks()

    def within(self, memory: Memory, jobs: int) -> Executor:
        """As in `Executor`; a single worker is this process. Without `max_memory`, no more than the machine, or the
        control group of this process, has memory for.
        """
        count = workers_that_fit(memory, min(self.workers, jobs), self._max_memory)
        return SerialExecutor() if count == 1 else ProcessExecutor(count, self._max_memory, self.peaks)

    def device(self, whole: Device, jobs: int) -> Device:
        """The threads are shared among the workers."""
        return whole.shared_among(min(self.workers, jobs))

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
        make_ready: Callable[[], None] | None = None,
    ) -> Iterator[tuple[int, Result]]:
        """As in `Executor`. `task`, jobs and results are pickled."""
        numbers = list(numbers)
        self.peaks.begin()
        with _pool(task, min(self.workers, len(numbers)), self.peaks, make_ready) as pool:
            yield from pool.run(numbers, job_of)


class _Ready:
    """The message of a process that can begin."""


@dataclass
class _Worker:
    """A process and the tile that is its. ready: whether it can begin, or has begun."""

    process: BaseProcess
    pipe: Connection
    tile: int | None = None
    ready: bool = False


class _Pool(Generic[Job, Result]):
    def __init__(
        self, task: Callable[[int, Job], Result], count: int, peaks: Peaks, make_ready: Callable[[], None] | None
    ) -> None:
        from multiprocessing import get_context

        self._task, self._make_ready, self._context = task, make_ready, get_context("spawn")
        self._peaks = peaks
        self._workers = [self._start() for _ in range(count)]

    def _start(self) -> _Worker:
        here, there = self._context.Pipe()
        process = self._context.Process(target=_work, args=(there, self._task, self._make_ready), daemon=True)
        process.start()
        there.close()
        return _Worker(process, here)

    def run(self, numbers: Iterable[int], job_of: Callable[[int], Job]) -> Iterator[tuple[int, Result]]:
        from multiprocessing.connection import wait

        waiting, tries = deque(numbers), Tries()
        while waiting or any(worker.tile is not None for worker in self._workers):
            for worker in self._workers:
                if worker.tile is None and waiting:
                    worker.tile = waiting.popleft()
                    if worker.ready:
                        self._send(worker, job_of)
            busy = {worker.pipe: worker for worker in self._workers if worker.tile is not None}
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index]
                number, outcome = self._outcome(worker)
                if isinstance(outcome, _Ready):
                    worker.tile, worker.ready = number, True
                    self._send(worker, job_of)
                    continue
                if not isinstance(outcome, Failure):
                    yield number, outcome
                    continue
                tries.failed(number, outcome)
                waiting.appendleft(number)

    def _send(self, worker: _Worker, job_of: Callable[[int], Job]) -> None:
        number = worker.tile or 0
        job = job_of(number)
        with contextlib.suppress(OSError):  # it died while it was idle: the pipe reports it to the waiting reader
            worker.pipe.send((number, job))

    def _outcome(self, worker: _Worker) -> tuple[int, Result | Failure | _Ready]:
        number, worker.tile = worker.tile or 0, None
        outcome: Result | Failure | _Ready
        try:
            peak, outcome = worker.pipe.recv()
            self._peaks.add(self._workers.index(worker), peak)
        except (EOFError, OSError):
            worker.process.join()
            outcome = Failure(f"its process ended with status {worker.process.exitcode}", False)
            worker.pipe.close()
            fresh = self._start()
            worker.process, worker.pipe, worker.ready = fresh.process, fresh.pipe, False
        return number, outcome

    def stop(self) -> None:
        """Ends all processes, whatever they are doing."""
        for worker in self._workers:
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join()
            worker.pipe.close()


@contextlib.contextmanager
def _pool(
    task: Callable[[int, Job], Result], count: int, peaks: Peaks, make_ready: Callable[[], None] | None
) -> Iterator[_Pool[Job, Result]]:
    pool = _Pool(task, count, peaks, make_ready)
    try:
        yield pool
    finally:
        pool.stop()


def _work(pipe: Connection, task: Callable[[int, Any], Any], make_ready: Callable[[], None] | None) -> None:
    """The life of a worker. It leaves Ctrl-C to the process that started it, whose end ends it too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if make_ready is not None:
        make_ready()
    with contextlib.suppress(OSError):
        pipe.send((own_peak(), _Ready()))
    while True:
        try:
            number, job = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            outcome = task(number, job)
        except Exception as error:
            outcome = Failure.of(error)
        del job
        try:
            pipe.send((own_peak(), outcome))
        except OSError:
            return
