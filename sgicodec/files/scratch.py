"""Folders for unfinished files, of which nothing is left: the next run removes those of one that was killed."""

from __future__ import annotations

import contextlib
import os
import platform
import shutil
import tempfile
import zlib
from collections.abc import Iterator
from pathlib import Path

from sgicodec.files.lock import lock_of

_PREFIX = f".sgicodec-{zlib.crc32(platform.node().encode()):08x}-"
"""Names the machine: locks may not reach from one to another that shares the disk."""


@contextlib.contextmanager
def scratch_folder(beside: Path | None = None) -> Iterator[Path]:
    """A new folder in the folder `beside`, or in that for temporary files, for as long as the context lasts.

    Its owner holds a lock on it. Folders that nobody holds, which only a killed process leaves, are removed. Raises
    OSError.
    """
    parent = Path(tempfile.gettempdir()) if beside is None else beside
    for left in parent.glob(f"{_PREFIX}*"):
        lock = _locked(left, wait=False)
        if lock is not None:
            _remove(left, lock)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=parent))
        lock = _locked(folder, wait=True)
        if folder.exists():
            break
        _release(lock)  # another run took it for one that was left
    try:
        yield folder
    finally:
        _remove(folder, lock)


def _remove(folder: Path, lock: int | None) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    _release(lock)


def _locked(folder: Path, wait: bool) -> int | None:
    """A descriptor that holds the lock of a folder; None if another does, or where there are no locks."""
    try:
        return lock_of(folder, wait=wait)
    except OSError:
        return None


def _release(lock: int | None) -> None:
    if lock is not None:
        os.close(lock)
