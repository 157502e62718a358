"""What libpng and LibRaw print to stderr by themselves, held back: their complaints come as errors, too."""

from __future__ import annotations

import contextlib
import os
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

_STDERR = 2
_LOCK = threading.RLock()


@contextlib.contextmanager
def without_libpng(is_png: bool = True) -> Iterator[None]:
    """While it lasts, what anything writes to stderr waits, and then goes there but for lines of libpng.

    Python's own stderr is the same file. Where there is none, or where `is_png` is False, nothing changes.
    """
    with _held_back(b"libpng error: ", b"libpng warning: ") if is_png else contextlib.nullcontext():
        yield


@contextlib.contextmanager
def without_libraw(path: Path) -> Iterator[None]:
    """The same of LibRaw, which begins its lines with the name of the file."""
    with _held_back(os.fsencode(path) + b": "):
        yield


@contextlib.contextmanager
def _held_back(*beginnings: bytes) -> Iterator[None]:
    with _LOCK:
        yield from _held_back_lines(beginnings)


def _held_back_lines(beginnings: tuple[bytes, ...]) -> Iterator[None]:
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
                if not line.startswith(beginnings):
                    os.write(_STDERR, line)
