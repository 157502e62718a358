"""The tiles of a picture on an executor: a worker is sent the pixels, or reads them itself."""

from __future__ import annotations

import atexit
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, NamedTuple, TypeVar

from sgicodec.cuda.choice import NamedDevice
from sgicodec.device import Device
from sgicodec.encoder.blas_threads import one_blas_thread
from sgicodec.encoder.input.windows import Windows, tile_window
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tiles.tasks import Task
from sgicodec.errors import PictureError
from sgicodec.executors.executor import Executor
from sgicodec.image.opened import Alpha
from sgicodec.image.source import Source, open_source
from sgicodec.image.used_range import SampleUse
from sgicodec.picture import Picture

__all__ = ["ReadingTask", "TileJob", "TileRunner", "TileTask"]

Result = TypeVar("Result")


class TileJob(NamedTuple):
    """What a worker is sent: the pixels, or None where it reads them itself, and where a search begins."""

    window: Picture | None
    start: bytes


class TileRunner:
    """Has an executor do tasks on tiles, with the threads of `device`."""

    def __init__(self, windows: Windows, plan: Plan, executor: Executor, device: Device) -> None:
        self._windows, self._plan, self._executor, self._device = windows, plan, executor, device

    def __call__(
        self,
        task: Task[Result],
        numbers: Sequence[int],
        start: Callable[[int], bytes] = lambda _: b"",
        window: Picture | None = None,
    ) -> Iterator[tuple[int, Result]]:
        """Results by tile, in any order. start: the payload of a tile that a search begins with; window: the pixels,
        instead of those that a tile covers. Raises TileFailedError.
        """
        executor, plan = self._executor, self._plan
        if not plan.header.tile:  # a listener hears of its steps, and its errors are the picture's
            tile = tile_window(self._windows, plan, 0)
            return iter([(0, task(0, tile, start(0), self._device))])
        device = executor.device(self._device, len(numbers))
        if executor.place is not None and window is None:
            reading = ReadingTask(plan, executor.place, task, device, self._windows.page)
            return executor.run(reading, numbers, lambda number: TileJob(None, start(number)))

        def job(number: int) -> TileJob:
            return TileJob(window or tile_window(self._windows, plan, number), start(number))

        return executor.run(TileTask(task, device), numbers, job)


@dataclass(frozen=True)
class TileTask(Generic[Result]):
    """Does a task to the pixels that come with the tile's number."""

    task: Task[Result]
    device: Device | NamedDevice

    def __call__(self, number: int, job: TileJob) -> Result:
        """What the task makes of the tile. Raises PictureError where no pixels came."""
        if job.window is None:
            raise PictureError("no pixels came")
        with one_blas_thread():
            return self.task(number, job.window, job.start, self.device.of_tile(number))


@dataclass(frozen=True)
class ReadingTask(Generic[Result]):
    """Reads the tile's pixels from a page of `place`, a path or a URL, which stays open between tiles."""

    plan: Plan
    place: str
    task: Task[Result]
    device: Device | NamedDevice
    page: int | None = None

    def __call__(self, number: int, job: TileJob) -> Result:
        """What the task makes of the tile. Raises PictureError for another picture than the plan's."""
        header = self.plan.header
        with _reading:
            use = SampleUse(header.sample_range, header.blank, header.has_exact)
            source = _opened(self.place, use, _ALPHA.get(header.channels, "auto"), self.page)
            opened = source.width, source.height, source.channels, str(source.dtype)
            if opened != (header.width, header.height, header.channels, header.sample_type):
                raise PictureError(f"{self.place}: this is another picture than the one being encoded")
            window = source.read(*header.grid.rect(number))
        job = TileJob(self.plan.of_header(window), job.start)
        return TileTask(self.task, self.device)(number, job)


_reading = threading.Lock()
_ALPHA: dict[str, Alpha] = {"multi": "band", "gray": "none", "rgb": "none"}
"""What a worker takes alpha for, by the channels of the plan, so that it reads what was planned for."""


@lru_cache(maxsize=1)
def _opened(place: str, use: SampleUse, alpha: Alpha, page: int | None) -> Source:
    return open_source(place, sample_range=use, alpha=alpha, page=page)


atexit.register(_opened.cache_clear)
