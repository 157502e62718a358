"""A lock on a file that is being written: a second program that would write it is refused, and told by whom."""

from __future__ import annotations

import contextlib
import os
import platform
import time
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from sgicodec.errors import OutputLockedError

try:
    import fcntl
except ImportError:  # where there is no fcntl, a second program is not noticed
    fcntl = None  # type: ignore[assignment]

__all__ = ["locked"]

_TRIES = 100
"""A holder that ends removes its lock's file: whoever opened that one before looks for the next."""
_MOST_TEXT = 300


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Holds the lock of `path`, which need not exist: a file beside it, gone at the end, and free after a kill.

    Raises OutputLockedError if it is held, by this process or another one. What is no regular file has no lock, nor
    have file systems that know none.
    """
    path = Path(os.path.realpath(path))
    if fcntl is None or (path.exists() and not path.is_file()):
        yield
        return
    beside = path.with_name(f".{path.name}.lock")
    try:
        file = _held(beside, path)
    except OSError:  # a name that is too long, a folder that cannot be written: writing reports it
        yield
        return
    with file:
        try:
            yield
        finally:
            with contextlib.suppress(OSError):
                beside.unlink()


def _held(beside: Path, path: Path) -> BinaryIO:
    """The file at `beside`, opened and locked, with who holds it inside."""
    for _ in range(_TRIES):
        with contextlib.ExitStack() as stack:
            file = stack.enter_context(beside.open("a+b"))
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise OutputLockedError(f"{path} is being written by {_holder(file)}; wait for it or end it") from None
            if not _is_at(file, beside):
                continue
            file.truncate(0)
            file.write(f"process {os.getpid()} on {platform.node()}, since {time.ctime()}".encode())
            file.flush()
            stack.pop_all()
            return file
    raise OSError(f"{beside} comes and goes")


def _is_at(file: BinaryIO, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False


def _holder(file: BinaryIO) -> str:
    """Who holds the lock, as it says."""
    file.seek(0)
    text = file.read(_MOST_TEXT).decode("utf-8", "replace")
    return "".join(filter(str.isprintable, text)) or "another encode"
