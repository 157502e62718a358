"""What libpng prints to stderr by itself, held back: its complaints come as errors, too."""

from __future__ import annotations

import contextlib
import os
import tempfile
import threading
from collections.abc import Iterator

__all__ = ["without_libpng"]

_STDERR = 2
_LOCK = threading.RLock()


@contextlib.contextmanager
def without_libpng(is_png: bool = True) -> Iterator[None]:
    """While it lasts, what anything writes to stderr waits, and then goes there but for lines of libpng.

    Python's own stderr is the same file. Where there is none, or where `is_png` is False, nothing changes.
    """
    with contextlib.ExitStack() as stack:
        if is_png:
            stack.enter_context(_LOCK)
            stack.enter_context(_held_back())
        yield


@contextlib.contextmanager
def _held_back() -> Iterator[None]:
    try:
        stderr = os.dup(_STDERR)
    except OSError:  # closed
        yield
        return
    with tempfile.TemporaryFile(buffering=0) as held:
        os.dup2(held.fileno(), _STDERR)
        try:
            yield
        finally:
            os.dup2(stderr, _STDERR)
            os.close(stderr)
            held.seek(0)
            for line in held.read().splitlines(keepends=True):
                if not line.startswith((b"libpng error: ", b"libpng warning: ")):
                    os.write(_STDERR, line)
