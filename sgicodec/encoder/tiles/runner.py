"""The tiles of a picture on an executor, whose workers are sent the pixels, or read them themselves."""

from __future__ import annotations

import atexit
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

from threadpoolctl import threadpool_limits

from sgicodec.cuda.choice import NamedDevice
from sgicodec.device import Device
from sgicodec.encoder.input.windows import Windows, tile_window
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tiles.tasks import Task
from sgicodec.errors import PictureError
from sgicodec.executors.executor import Executor
from sgicodec.image.opened import Alpha
from sgicodec.image.source import Source, open_source
from sgicodec.image.used_range import SampleUse
from sgicodec.picture import Picture

Result = TypeVar("Result")


class TileRunner:
    """Has an executor do tasks on tiles, with the threads of `device`."""

    def __init__(self, windows: Windows, plan: Plan, executor: Executor, device: Device) -> None:
        self._windows, self._plan, self._executor, self._device = windows, plan, executor, device

    def __call__(
        self, task: Task[Result], numbers: Sequence[int], window: Picture | None = None
    ) -> Iterator[tuple[int, Result]]:
        """Results by tile, in any order. window: the pixels, instead of those that a tile covers. Raises
        TileFailedError.
        """
        executor, plan = self._executor, self._plan
        if not plan.header.tile:  # a listener hears of its steps, and its errors are the picture's
            tile = tile_window(self._windows, plan, 0)
            return iter([(0, task(0, tile, self._device))])
        device = executor.device(self._device, len(numbers))
        there = None if executor.place is None else PictureAt(plan, executor.place, self._windows.page)

        def job(number: int) -> Picture | PictureAt:
            """The pixels, or where a worker reads them itself."""
            return window or there or tile_window(self._windows, plan, number)

        return executor.run(TileTask(task, device), numbers, job)


@dataclass(frozen=True)
class TileTask(Generic[Result]):
    """Does a task to tiles whose pixels are sent, or lie where a worker reads them."""

    task: Task[Result]
    device: Device | NamedDevice

    def __call__(self, number: int, job: Picture | PictureAt) -> Result:
        """What the task makes of the tile. Raises PictureError where its pixels cannot be read."""
        window = job if isinstance(job, Picture) else job.window(number)
        with one_blas_thread():
            return self.task(number, window, self.device.found())


@dataclass(frozen=True)
class PictureAt:
    """A page of `place`, a path or a URL, which stays open between tiles."""

    plan: Plan
    place: str
    page: int | None = None

    def window(self, number: int) -> Picture:
        """The pixels of a tile. Raises PictureError for another picture than the plan's."""
        header = self.plan.header
        with _reading:
            use = SampleUse(header.sample_range, header.blank, header.has_exact)
            source = _opened(self.place, use, _ALPHA.get(header.channels, "auto"), self.page)
            opened = source.width, source.height, source.channels, str(source.dtype)
            if opened != (header.width, header.height, header.channels, header.sample_type):
                raise PictureError(f"{self.place}: this is another picture than the one being encoded")
            return self.plan.of_header(source.read(*header.grid.rect(number)))


_reading = threading.Lock()
_ALPHA: dict[str, Alpha] = {"multi": "band", "gray": "none", "rgb": "none"}
"""What a worker takes alpha for, by the channels of the plan, so that it reads what was planned for."""


@lru_cache(maxsize=1)
def _opened(place: str, use: SampleUse, alpha: Alpha, page: int | None) -> Source:
    return open_source(place, sample_range=use, alpha=alpha, page=page)


atexit.register(_opened.cache_clear)

_VARIABLE = "OPENBLAS_NUM_THREADS"
"""By which somebody chose already; the command line does, before numpy loads."""
_setting = threading.Lock()
"""Held by the encode that has set the limit."""


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """BLAS has one thread meanwhile, in the whole process. Products are too small to share here, and threads that wait
    for the next one spin: a quarter of the processor time of an encode.

    Of encodes side by side, the one that set the limit takes it away when it ends; others may go on without. A program
    that sets OPENBLAS_NUM_THREADS keeps that.
    """
    if _VARIABLE in os.environ or not _setting.acquire(blocking=False):
        yield
        return
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            yield
    finally:
        _setting.release()
