"""Which GPU of a machine is this process's, where several processes share them without knowing each other."""

from __future__ import annotations

import os
import tempfile
from functools import cache
from itertools import count
from pathlib import Path
from typing import BinaryIO, NamedTuple

from sgicodec.cuda.driver import the_driver

try:
    import fcntl
except ImportError:  # where there is no fcntl, all processes take the first
    fcntl = None  # type: ignore[assignment]

__all__ = ["claimed_gpu"]


class _Claim(NamedTuple):
    """gpu: its number as this process sees it. file: locked while this process lives."""

    gpu: int
    file: BinaryIO | None = None


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
    if fcntl is None or driver.count == 1:
        return _Claim(0)
    user, names = os.getuid(), [driver.identity(index) for index in range(driver.count)]
    try:
        for place in count():
            for gpu, name in enumerate(names):
                file = _locked(Path(tempfile.gettempdir(), f"sgicodec-{user}-{name}-{place}.lock"))
                if file is not None:
                    return _Claim(gpu, file)
    except OSError:  # nothing can be written there
        pass
    return _Claim(0)


def _locked(path: Path) -> BinaryIO | None:
    file = path.open("ab")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        return None
    except OSError:
        file.close()
        raise
    return file
