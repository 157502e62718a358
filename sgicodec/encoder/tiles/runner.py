"""The tiles of a picture on an executor: as many workers as there is memory for (docs/large.md, "Memory"), each of
which is sent the pixels, or reads them itself.
"""

from __future__ import annotations

import atexit
import math
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

import numpy as np
from threadpoolctl import threadpool_limits

from sgicodec.cuda.choice import NamedDevice
from sgicodec.device import Device
from sgicodec.encoder.input.windows import Windows, tile_window
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tiles.tasks import Task
from sgicodec.errors import PictureError
from sgicodec.executors.executor import MIB, Executor, Memory
from sgicodec.image.opened import Alpha
from sgicodec.image.source import Source, open_source
from sgicodec.image.used_range import SampleUse
from sgicodec.picture import Picture
from sgicodec.profiles.default import lmbda_of_quality

__all__ = ["PictureAt", "TileRunner", "TileTask", "one_blas_thread", "within_memory"]

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

MAIN = 150 * MIB
"""The process that reads and writes: Python, numpy, OpenImageIO. One that fits too has room for them in WORKER."""
WORKER = 110 * MIB
"""A process that fits: Python, numpy, and what a fit takes of any size."""
PIXEL_BYTES, CHANNEL_BYTES = 52, 16
"""Of images in a fit for each pixel, and for each of its channels."""
SEED_BYTES = 1400
"""Of a fit for each seed that it starts with."""
UNIFORM_SAMPLE_BYTES, UNIFORM_ATTRIBUTE_BYTES = 6, 100
"""In a uniform layout: for each sample, and for each attribute of each seed, 7.4 kB for the 74 of K = 10, D = 50.
Measured with 1,000 and 40,000 seeds in 0.4 megapixels 110 and 381 MiB, with 350,000 in 52.3 megapixels 3,318."""
SCORED_PIXEL_BYTES, SCORED_CHANNEL_BYTES = 140, 50
"""For each pixel, and for each of its channels, while a score says what texture should show."""
MAX_SEEDS, USUAL_SEEDS, USUAL_LMBDA = 0.25, 0.1, lmbda_of_quality(50)
"""Seeds for each pixel: cells have four pixels at least; dense texture starts with a tenth at quality 50."""


def within_memory(windows: Windows, plan: Plan, executor: Executor | None) -> tuple[Executor, Memory]:
    """The executor, by default this process, with no more workers than there is memory for, and what that takes at its
    peak. Raises UsageError where one is too many.
    """
    grid = plan.header.grid
    memory = _estimate(plan, windows.memory(*grid.rect(0)[2:]))
    return (executor or Executor()).within(memory, grid.count), memory


def _estimate(plan: Plan, reading: int) -> Memory:
    """For dense detail; `reading` is what the source holds while its windows are read."""
    header, fit = plan.header, plan.settings.fit_settings()
    _, _, width, height = header.grid.rect(0)
    pixels, channels = (width + 2 * header.apron) * (height + 2 * header.apron), header.spec.channels
    window = pixels * channels * np.dtype(header.sample_type).itemsize
    if header.spec.layout == "uniform":
        attributes = (fit.seeds or pixels / 400) * header.spec.attributes
        fitting = pixels * channels * UNIFORM_SAMPLE_BYTES + attributes * UNIFORM_ATTRIBUTE_BYTES
        return Memory(MAIN + reading + 2 * window, WORKER + window + round(fitting), MAIN)
    share = MAX_SEEDS  # where the quality follows from a target
    if plan.settings.target is None:
        share = min(MAX_SEEDS, USUAL_SEEDS * math.sqrt(USUAL_LMBDA / max(fit.lmbda, 1e-9)))
    fitting = pixels * (PIXEL_BYTES + CHANNEL_BYTES * channels + SEED_BYTES * share)
    if header.spec.texture and plan.settings.chosen_effort.ascent_passes:
        fitting = max(fitting, pixels * (SCORED_PIXEL_BYTES + SCORED_CHANNEL_BYTES * channels))
    return Memory(MAIN + reading + 2 * window, WORKER + window + round(fitting), MAIN)


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
