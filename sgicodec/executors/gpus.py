"""Tiles over several GPUs of this machine: a process for each, and threads within it."""

from __future__ import annotations

import os
from dataclasses import replace

from sgicodec.device import Device
from sgicodec.errors import NoDeviceError, UsageError
from sgicodec.executors.peak import Peaks
from sgicodec.executors.processes import ProcessExecutor

__all__ = ["GpuExecutor"]

_VISIBLE = "CUDA_VISIBLE_DEVICES"
"""Names the GPUs that NVIDIA's driver shows to a process; there they are numbered from 0."""


class GpuExecutor(ProcessExecutor):
    """An `Executor` with a process of this machine for each of several GPUs, which sees that one alone. Tiles within a
    process are done in threads, whose steps share the GPU as with `ThreadExecutor`.

    gpus: how many, from number `first` on. workers: tiles at once over all of them, at most; 0 for one per core and one
    for each GPU. peaks: where they tell what they took.
    """

    def __init__(
        self,
        gpus: int,
        workers: int = 0,
        max_memory: float | None = None,
        first: int = 0,
        peaks: Peaks | None = None,
    ) -> None:
        if not isinstance(gpus, int) or gpus < 1:
            raise UsageError(f"gpus {gpus!r}; 1 or more")
        super().__init__(workers, max_memory, peaks)
        self.workers += 0 if workers else gpus
        self._gpus, self._first = min(gpus, self.workers), first
        self._threads = self.workers // self._gpus
        self.workers = self._gpus * self._threads

    def _with(self, workers: int) -> GpuExecutor:
        return GpuExecutor(self._gpus, workers, self._max_memory, self._first, self.peaks)

    def device(self, whole: Device, jobs: int) -> Device:
        """The only GPU of its process, and a share of the threads."""
        own = super().device(whole, jobs)
        return own if own.gpu is None else replace(own, gpu=0, gpus=1)

    def _environments(self, jobs: int) -> list[dict[str, str]]:
        return [{_VISIBLE: _name_of(self._first + gpu)} for gpu in range(min(self._gpus, jobs))]


def _name_of(gpu: int) -> str:
    """What the driver calls a GPU that this process numbers so."""
    named = os.environ.get(_VISIBLE)
    if named is None:
        return str(gpu)
    names = named.split(",")
    if gpu >= len(names):
        raise NoDeviceError(f"no GPU {gpu}: {_VISIBLE} names {len(names)}")
    return names[gpu].strip()
