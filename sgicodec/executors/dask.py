"""Tiles over the workers of a Dask distributed cluster. The only user of Dask."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import Any, TypeVar

from sgicodec.cuda.choice import NamedDevice, check_name
from sgicodec.device import Device
from sgicodec.errors import MissingExtraError, NoDeviceError, UsageError, require
from sgicodec.executors.executor import Executor, Failure, Tries

Job = TypeVar("Job")
Result = TypeVar("Result")

_AHEAD = 2
"""Tiles that are on their way for each thread of the cluster: pixels that wait take memory."""


class Cluster(Executor):
    """An `Executor` on an open cluster, which knows what memory its workers have. place: path or URL where they read
    the picture; None to send pixels. device: the name of what computes, which each worker finds at its own machine;
    None for what the encode is given.
    """

    def __init__(self, client: Any, place: str | None, device: str | None = None) -> None:
        self._client, self.place, self._device = client, place, device

    @property
    def workers(self) -> int:
        """How many tiles it takes at once."""
        return max(1, int(sum(self._client.nthreads().values())))

    def device(self, whole: Device, jobs: int) -> Device | NamedDevice:
        """As many threads for each job as were asked for, one where none were: a worker runs several jobs at once."""
        own = whole.with_threads(max(1, whole.threads))
        return own if self._device is None else NamedDevice(self._device, own.processor)

    def run(
        self,
        task: Callable[[int, Job], Result],
        numbers: Iterable[int],
        job_of: Callable[[int], Job],
    ) -> Iterator[tuple[int, Result]]:
        """As in `Executor`. A tile whose worker died goes to another one. Some jobs are on their way
        before a worker can begin.
        """
        from distributed import as_completed

        waiting, tries, tiles = deque(numbers), Tries(), dict[Any, int]()
        done, ahead = as_completed(), _AHEAD * self.workers

        def submit() -> None:
            number = waiting.popleft()
            future = self._client.submit(_outcome, task, number, job_of(number), pure=False)
            tiles[future] = number
            done.add(future)

        while waiting and len(tiles) < ahead:
            submit()
        for future in done:
            number = tiles.pop(future)
            outcome = future.result() if future.status == "finished" else _lost(future)
            if isinstance(outcome, Failure):
                tries.failed(number, outcome)
                waiting.appendleft(number)
            else:
                yield number, outcome
            if waiting:
                submit()


def _outcome(task: Callable[[int, Job], Result], number: int, job: Job) -> Result | Failure:
    try:
        return task(number, job)
    except (MissingExtraError, NoDeviceError) as error:
        from distributed import get_worker

        return Failure(f"worker {get_worker().address}: {error}", True)
    except Exception as error:
        return Failure.of(error)


def _lost(future: Any) -> Failure:
    """What Dask says of a tile that took several workers with it."""
    error = future.exception() if future.status == "error" else None
    return Failure(f"the cluster gave it up ({error or future.status})", False)


def open_cluster(address: str, place: str | None = None, device: str | None = None) -> AbstractContextManager[Cluster]:
    """A cluster by the address of its scheduler, or "local:N": one of N processes on this machine. place, device: as in
    `Cluster`.

    Raises UsageError for what is no address or device, if Dask is not installed, or, on entering, if no cluster
    answers.
    """
    if not isinstance(address, str):
        raise UsageError(f'cluster {address!r}; give the address of a scheduler, or "local:4"')
    if place is not None and not isinstance(place, str):
        raise UsageError(f"place {place!r}; give the path or URL at which workers read the picture")
    if device is not None:
        check_name(device)
    _local_processes(address)
    require("distributed", "a cluster", "cluster")
    return _opened(address, place, device)


def _local_processes(address: str) -> int | None:
    """Of "local:N" the N. Raises UsageError for what no number of processes is."""
    if not address.startswith("local:"):
        return None
    count = address.removeprefix("local:")
    if not count.isdecimal() or not 1 <= int(count) <= 1024:
        raise UsageError(f"cluster {address}: a number of processes must follow, as in local:4")
    return int(count)


@contextmanager
def _opened(address: str, place: str | None, device: str | None) -> Iterator[Cluster]:
    from distributed import Client, LocalCluster

    with ExitStack() as stack:
        if (count := _local_processes(address)) is not None:
            options = {"n_workers": count, "threads_per_worker": 1, "dashboard_address": None}
            scheduler: Any = stack.enter_context(LocalCluster(**options, memory_limit=0))
        else:
            scheduler = address
        try:
            client = stack.enter_context(Client(scheduler, timeout=_PATIENCE_SECONDS))
        except (OSError, ValueError) as error:
            raise UsageError(f"cluster {address}: {error or 'no scheduler answers there'}") from error
        yield Cluster(client, place, device)


_PATIENCE_SECONDS = 10
