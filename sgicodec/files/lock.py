"""Locks: one holder of a file or folder at a time, which is free when its holder ends or is killed."""

from __future__ import annotations

import contextlib
import errno
import os
import platform
import time
from collections.abc import Iterator
from pathlib import Path

from sgicodec.errors import OutputLockedError

try:
    import fcntl
except ImportError:  # where there is no fcntl, a second program is not noticed
    fcntl = None  # type: ignore[assignment]

_TRIES = 100
"""A holder that ends removes its lock's file: whoever opened that one before looks for the next."""
_HOLDER, _MAX_TEXT = b"process ", 300
"""How a lock's file begins, and what is read of it."""


def lock_of(path: Path, *, create: bool = False, wait: bool = False) -> int:
    """A descriptor that holds the lock of what lies at `path`, until it is closed; `create`: a new file there at need.

    Raises BlockingIOError if another one has it, unless it is to `wait`; another OSError if nothing can be opened
    there, or where files have no locks.
    """
    if fcntl is None:
        raise OSError(errno.ENOTSUP, "files have no locks here")
    descriptor = os.open(path, os.O_NOFOLLOW | (os.O_RDWR | os.O_CREAT if create else os.O_RDONLY), 0o666)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Holds the lock of `path`, which need not exist: a file beside it, gone at the end, and free after a kill.

    Raises OutputLockedError if it is held, by this process or another one. What is no regular file has no lock, nor
    have file systems that know none.
    """
    if path.exists() and not path.is_file():
        yield
        return
    path = Path(os.path.realpath(path))
    beside = lock_file(path)
    try:
        descriptor = _held(beside, path)
    except OSError:  # a name that is too long, a folder that cannot be written: writing reports it
        yield
        return
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()
        os.close(descriptor)


def lock_file(path: Path) -> Path:
    """The file that stands for the lock of what lies at `path`."""
    return path.with_name(f".{path.name}.lock")


def _held(beside: Path, path: Path) -> int:
    """The lock of the file at `beside`, with who holds it inside. Raises OSError for a link, and a file that is no
    lock.
    """
    for _ in range(_TRIES):
        try:
            descriptor = lock_of(beside, create=True)
        except BlockingIOError:
            raise OutputLockedError(f"{path} is being written by {_holder(beside)}; wait for it or end it") from None
        if _is_at(descriptor, beside):
            if os.pread(descriptor, len(_HOLDER), 0) not in (b"", _HOLDER):
                os.close(descriptor)
                raise OSError(f"{beside} is no lock")
            with contextlib.suppress(OSError):  # a full disk holds an empty file, whose lock is as good
                os.truncate(descriptor, 0)
                os.write(descriptor, _HOLDER + f"{os.getpid()} on {platform.node()}, since {time.ctime()}".encode())
            return descriptor
        os.close(descriptor)
    raise OSError(f"{beside} comes and goes")


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _holder(beside: Path) -> str:
    """Who holds the lock, as its file says."""
    with contextlib.suppress(OSError), beside.open("rb") as file:
        text = "".join(filter(str.isprintable, file.read(_MAX_TEXT).decode("utf-8", "replace")))
        if text:
            return text
    return "another encode"
