"""Which GPU of a machine is this process's, where several processes share them without knowing each other."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path
from typing import NamedTuple

from sgicodec.cuda.driver import the_driver
from sgicodec.files.lock import lock_of

__all__ = ["claimed_gpu"]


class _Claim(NamedTuple):
    """gpu: its number as this process sees it. lock: held while this process lives."""

    gpu: int
    lock: int | None = None


def claimed_gpu() -> int:
    """The number of the GPU that fewest processes of this machine and user have claimed, the first of equals; the same
    for as long as this process lives. Raises NoDeviceError where there is none.
    """
    return _claim().gpu


@cache
def _claim() -> _Claim:
    """A GPU has as many lock files as processes have claimed it, in the folder of temporary files: a kill frees them,
    and a GPU is known by its identity, as each process may see it under another number (CUDA_VISIBLE_DEVICES).
    """
    driver = the_driver()
    if driver.count == 1:
        return _Claim(0)
    user, names = getattr(os, "getuid", int)(), [driver.identity(index) for index in range(driver.count)]
    try:
        for turn in count():
            for gpu, name in enumerate(names):
                path = Path(tempfile.gettempdir(), f"sgicodec-{user}-{name}-{turn}.lock")
                with suppress(BlockingIOError):
                    return _Claim(gpu, lock_of(path, create=True))
    except OSError:  # nothing can be written there, or files have no locks
        pass
    return _Claim(0)
