"""Unfinished files and folders of them, of which nothing is left: the next run removes those of one that was killed."""

from __future__ import annotations

import contextlib
import os
import platform
import shutil
import tempfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

from sgicodec.files.lock import lock_of

__all__ = ["scratch_file", "scratch_folder"]

_PREFIX = f".sgicodec-{zlib.crc32(platform.node().encode()):08x}-"
"""Names the machine: locks may not reach from one to another that shares the disk."""
_SUFFIX = ".sgi-part"
"""Of a file, which is no folder."""


@contextlib.contextmanager
def scratch_folder(beside: Path | None = None) -> Iterator[Path]:
    """A new folder in the folder `beside`, or in that for temporary files, for as long as the context lasts.

    Its owner holds a lock on it. Folders that nobody holds, which only a killed process leaves, are removed. Raises
    OSError.
    """
    parent = Path(tempfile.gettempdir()) if beside is None else beside
    with _held(parent, f"{_PREFIX}*", lambda: Path(tempfile.mkdtemp(prefix=_PREFIX, dir=parent))) as folder:
        yield folder


@contextlib.contextmanager
def scratch_file(beside: Path) -> Iterator[Path]:
    """A new empty file in the folder `beside`, which is removed at the end unless it was renamed.

    It is held as a folder is, and its permissions follow the umask. Raises OSError.
    """

    def make() -> Path:
        path = beside / f"{_PREFIX}{os.urandom(4).hex()}{_SUFFIX}"
        path.open("xb").close()
        return path

    with _held(beside, f"{_PREFIX}*{_SUFFIX}", make) as path:
        yield path


@contextlib.contextmanager
def _held(parent: Path, like: str, make: Callable[[], Path]) -> Iterator[Path]:
    """What `make` puts into `parent`, locked until it is removed; what others left under such names goes first."""
    for left in parent.glob(like):
        _remove_if_left(left)
    while True:
        path = make()
        lock = _locked(path, wait=True)
        if path.exists():
            break
        _release(lock)  # another run took it for one that was left
    try:
        yield path
    finally:
        _remove(path)
        _release(lock)


def _remove_if_left(path: Path) -> None:
    lock = _locked(path, wait=False)
    if lock is not None:
        _remove(path)
        _release(lock)


def _remove(path: Path) -> None:
    if path.name.endswith(_SUFFIX):
        with contextlib.suppress(OSError):
            path.unlink()
    else:
        shutil.rmtree(path, ignore_errors=True)


def _locked(path: Path, wait: bool) -> int | None:
    """A descriptor that holds the lock of a folder or a file; None if another does, or where there are no locks."""
    try:
        return lock_of(path, wait=wait)
    except OSError:
        return None


def _release(lock: int | None) -> None:
    if lock is not None:
        os.close(lock)
