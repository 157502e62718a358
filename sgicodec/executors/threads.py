"""Tiles over several threads of this process: while one is searched on the processor, a GPU fits others."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event
from typing import TypeVar

from sgicodec.executors.executor import Failure, Tries
from sgicodec.executors.local import LocalExecutor

__all__ = ["ThreadExecutor", "stopping"]

Job = TypeVar("Job")
Result = TypeVar("Result")

_stop: ContextVar[Event | None] = ContextVar("stop", default=None)


def stopping() -> bool:
    """Whether nobody waits any more for the job that this thread is doing."""
    event = _stop.get()
    return event is not None and event.is_set()


class ThreadExecutor(LocalExecutor):
    """An `Executor` with threads of this process, for tiles that a GPU fits: their steps share it, each thread with
    launches in an order of its own. On the processor alone, processes are faster.

    workers: at most; 0 for one per core and one that waits for the GPU. A run
    that ends early lets the tiles under way end: they see that they are `stopping`.
    """

    def __init__(self, workers: int = 0, max_memory: float | None = None) -> None:
        super().__init__(workers, (os.cpu_count() or 1) + 1, max_memory)

    def _with(self, workers: int) -> ThreadExecutor:
        return ThreadExecutor(workers, self._max_memory)

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
    ) -> Iterator[tuple[int, Result]]:
        """As in `Executor`."""
        waiting, tries = deque(numbers), Tries()
        running = dict[Future[Result], int]()
        with _pool(self.workers) as pool:
            while waiting or running:
                while waiting and len(running) < self.workers:
                    number = waiting.popleft()
                    running[pool.submit(task, number, job_of(number))] = number
                for done in wait(running, return_when=FIRST_COMPLETED).done:
                    number, error = running.pop(done), done.exception()
                    if error is None:
                        yield number, done.result()
                        continue
                    if not isinstance(error, Exception):
                        raise error
                    tries.failed(number, Failure.of(error), error)
                    waiting.appendleft(number)


@contextmanager
def _pool(workers: int) -> Iterator[ThreadPoolExecutor]:
    event = Event()
    with ThreadPoolExecutor(workers, initializer=_stop.set, initargs=(event,)) as pool:
        try:
            yield pool
        finally:
            event.set()
            pool.shutdown(wait=False, cancel_futures=True)
