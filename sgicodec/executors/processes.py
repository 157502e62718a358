"""Tiles over several processes of this machine. One that dies is replaced; its tile gets a second try."""

from __future__ import annotations

import contextlib
import math
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from sgicodec.device import Device, own_cores
from sgicodec.errors import UsageError
from sgicodec.executors.available import group_memory, machine_memory
from sgicodec.executors.executor import MIB, Executor, Failure, Memory, Tries
from sgicodec.executors.peak import Peaks, own_peak

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

Job = TypeVar("Job")
Result = TypeVar("Result")


class ProcessExecutor(Executor):
    """An `Executor` with worker processes of this machine, started for each run.

    workers: how many at most; 0 for one per core. max_memory: bytes that all processes may take together at their peak,
    by the estimate; None for what the machine, or the control group of this process, has. peaks: where workers tell
    what they took. Raises UsageError.
    """

    workers = 1

    def __init__(self, workers: int = 0, max_memory: float | None = None, peaks: Peaks | None = None) -> None:
        if not isinstance(workers, int) or workers < 0:
            raise UsageError(f"workers {workers!r}; 0 (by the number of cores) or more")
        self.workers, self._max_memory = workers or own_cores(), max_memory
        self.peaks = peaks or Peaks()

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
        return Executor() if count == 1 else ProcessExecutor(count, limit, self.peaks)

    def device(self, whole: Device, jobs: int) -> Device:
        """The threads are shared among the workers."""
        return whole.shared_among(min(self.workers, jobs))

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
    ) -> Iterator[tuple[int, Result]]:
        """As in `Executor`. `task`, jobs and results are pickled."""
        numbers = list(numbers)
        self.peaks.begin()
        pool = _Pool(task, min(self.workers, len(numbers)), self.peaks)
        with contextlib.closing(pool):
            yield from pool.run(numbers, job_of)


@dataclass
class _Worker:
    """A process and the tile that is its, if one is. ready: whether it can begin, or has begun."""

    process: BaseProcess
    pipe: Connection
    tile: int | None = None
    ready: bool = False


class _Pool(Generic[Job, Result]):
    def __init__(self, task: Callable[[int, Job], Result], workers: int, peaks: Peaks) -> None:
        from multiprocessing import get_context

        self._task, self._context = task, get_context("spawn")
        self._peaks, self._workers = peaks, list[_Worker]()
        try:
            while len(self._workers) < workers:
                self._workers.append(self._start())
        except BaseException:
            self.close()
            raise

    def _start(self) -> _Worker:
        here, there = self._context.Pipe()
        process = self._context.Process(target=_work, args=(there, self._task), daemon=True)
        with _without_interrupts():
            process.start()
        there.close()
        return _Worker(process, here)

    def run(self, numbers: Iterable[int], job_of: Callable[[int], Job]) -> Iterator[tuple[int, Result]]:
        from multiprocessing.connection import wait

        waiting, tries = deque(numbers), Tries()
        while waiting or any(worker.tile is not None for worker in self._workers):
            self._hand_out(waiting, job_of)
            busy = {worker.pipe: worker for worker in self._workers if worker.tile is not None}
            for pipe in wait(list(busy)):
                found = self._outcome(busy[pipe], job_of)  # type: ignore[index]
                if found is None:
                    continue
                number, outcome = found
                if not isinstance(outcome, Failure):
                    yield number, outcome
                    continue
                tries.failed(number, outcome)
                waiting.appendleft(number)

    def _hand_out(self, waiting: deque[int], job_of: Callable[[int], Job]) -> None:
        """Gives tiles to whoever has none."""
        for worker in self._workers:
            if not waiting:
                return
            if worker.tile is None:
                worker.tile = waiting.popleft()
                if worker.ready:
                    self._send(worker, worker.tile, job_of)

    def _send(self, worker: _Worker, number: int, job_of: Callable[[int], Job]) -> None:
        job = job_of(number)
        with contextlib.suppress(OSError):  # it died while it was idle: the pipe reports it to the waiting reader
            worker.pipe.send((number, job))

    def _outcome(self, worker: _Worker, job_of: Callable[[int], Job]) -> tuple[int, Result | Failure] | None:
        """What became of a worker's tile, also where it died; None where it says that it is ready."""
        place, tile = self._workers.index(worker), worker.tile
        assert tile is not None
        try:
            peak, is_done, outcome = worker.pipe.recv()
        except (EOFError, OSError):
            worker.process.join()
            failure = Failure(f"its process ended with status {worker.process.exitcode}", False)
            worker.pipe.close()
            self._workers[place] = self._start()
            return tile, failure
        self._peaks.add(place, peak)
        if not is_done:
            worker.ready = True
            self._send(worker, tile, job_of)
            return None
        worker.tile = None
        return tile, outcome

    def close(self) -> None:
        """Ends all processes, whatever they are doing."""
        for worker in self._workers:
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join()
            worker.pipe.close()


@contextlib.contextmanager
def _without_interrupts() -> Iterator[None]:
    """A block after which Ctrl-C is heard again here, and never by processes that it starts: one that only loads would
    print a trace.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    old = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old)


def _end_with_parent() -> None:
    """Ends this process when the one that started it is gone, whatever it is doing."""
    from multiprocessing import parent_process

    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _work(pipe: Connection, task: Callable[[int, Any], Any]) -> None:
    """The life of a worker. It leaves Ctrl-C to the process that started it, whose end ends it too."""
    from sgicodec._native import keep_freed_memory

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(RuntimeError):  # no thread to be had: it ends after its tile
        threading.Thread(target=_end_with_parent, daemon=True).start()
    keep_freed_memory()
    with contextlib.suppress(EOFError, OSError):  # nobody is there any more: the pipe ends
        pipe.send((own_peak(), False, None))
        while True:
            number, job = pipe.recv()
            try:
                outcome = task(number, job)
            except Exception as error:
                outcome = Failure.of(error)
            del job
            pipe.send((own_peak(), True, outcome))
            del outcome
