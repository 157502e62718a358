"""Tiles over several processes of this machine. One that dies is replaced; its tile gets a second try."""

from __future__ import annotations

import contextlib
import signal
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Generic, TypeVar

from sgicodec.errors import SgiError, TileFailedError

__all__ = ["Failure", "run_here", "run_in_processes"]

Job = TypeVar("Job")
Result = TypeVar("Result")

_TRIES = 2


@dataclass(frozen=True)
class Failure:
    """What became of a job that raised. final: another try would end the same way."""

    message: str
    final: bool

    @classmethod
    def of(cls, error: Exception) -> Failure:
        """An error of the input's is final; others may be the machine's."""
        return cls(str(error) or type(error).__name__, isinstance(error, SgiError))


def run_here(
    task: Callable[[int, Job], Result], numbers: Iterable[int], job_of: Callable[[int], Job]
) -> Iterator[tuple[int, Result]]:
    """Tile after tile in this process. Raises TileFailedError."""
    for number in numbers:
        for attempt in range(_TRIES):
            try:
                result = task(number, job_of(number))
            except Exception as error:
                failure = Failure.of(error)
                if failure.final or attempt == _TRIES - 1:
                    raise TileFailedError(number, failure.message) from error
            else:
                yield number, result
                break


class _Ready:
    """What a process says when it can begin."""


@dataclass
class _Worker:
    """A process and the tile that is its. ready: whether it can begin, or has begun."""

    process: BaseProcess
    pipe: Connection
    tile: int | None = None
    ready: bool = False


class _Pool(Generic[Job, Result]):
    def __init__(
        self, task: Callable[[int, Job], Result], count: int, make_ready: Callable[[], None] | None = None
    ) -> None:
        self._task, self._make_ready, self._context = task, make_ready, get_context("spawn")
        self._workers = [self._start() for _ in range(count)]

    def _start(self) -> _Worker:
        here, there = self._context.Pipe()
        process = self._context.Process(target=_work, args=(there, self._task, self._make_ready), daemon=True)
        process.start()
        there.close()
        return _Worker(process, here)

    def run(self, numbers: Iterable[int], job_of: Callable[[int], Job]) -> Iterator[tuple[int, Result]]:
        waiting, failures = deque(numbers), Counter[int]()
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
                failures[number] += 1
                if outcome.final or failures[number] == _TRIES:
                    raise TileFailedError(number, outcome.message)
                waiting.appendleft(number)

    def _send(self, worker: _Worker, job_of: Callable[[int], Job]) -> None:
        number = worker.tile or 0
        job = job_of(number)
        with contextlib.suppress(OSError):  # it died while it was idle: the pipe tells so to whoever waits
            worker.pipe.send((number, job))

    def _outcome(self, worker: _Worker) -> tuple[int, Result | Failure | _Ready]:
        number, worker.tile = worker.tile or 0, None
        try:
            outcome: Result | Failure | _Ready = worker.pipe.recv()
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
    task: Callable[[int, Job], Result], count: int, make_ready: Callable[[], None] | None
) -> Iterator[_Pool[Job, Result]]:
    pool = _Pool(task, count, make_ready)
    try:
        yield pool
    finally:
        pool.stop()


def run_in_processes(
    task: Callable[[int, Job], Result],
    numbers: Iterable[int],
    job_of: Callable[[int], Job],
    count: int,
    make_ready: Callable[[], None] | None = None,
) -> Iterator[tuple[int, Result]]:
    """Results of task(number, job_of(number)) as they come, from `count` processes; `job_of` runs in this one, at the
    moment when one of them can begin: before its first job it calls `make_ready`.

    `task` and jobs are pickled. Raises TileFailedError for a tile that failed twice, or once for what is the input's.
    """
    with _pool(task, count, make_ready) as pool:
        yield from pool.run(numbers, job_of)


def _work(pipe: Connection, task: Callable[[int, Any], Any], make_ready: Callable[[], None] | None) -> None:
    """The life of a worker. It leaves Ctrl-C to the process that started it, whose end ends it too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if make_ready is not None:
        make_ready()
    with contextlib.suppress(OSError):
        pipe.send(_Ready())
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
            pipe.send(outcome)
        except OSError:
            return
