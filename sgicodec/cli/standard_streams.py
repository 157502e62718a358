"""Standard streams that are closed, full or broken: one clear line, and no file of ours in their place."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from typing import Any, NoReturn

from sgicodec.errors import ReportError, UsageError

_NAMES = ("stdin", "stdout", "stderr")


def repair() -> None:
    """Opens descriptors that are closed, lest the next file become one of them; reports that cannot be written raise
    ReportError, complaints that cannot are dropped.
    """
    for number, name in enumerate(_NAMES):
        try:
            os.fstat(number)
        except OSError:
            drop(number)
            setattr(sys, name, None)
    if sys.stdin is None:
        sys.stdin = _ClosedInput()
    sys.stdout = _wrapped(sys.stdout, _Report, _ClosedReport, 1)
    sys.stderr = _wrapped(sys.stderr, _Complaints, _Complaints, 2)


def drop(number: int) -> None:
    """Makes a descriptor one that takes everything and gives nothing."""
    null = os.open(os.devnull, os.O_RDWR)
    if null != number:
        os.dup2(null, number)
        os.close(null)


def check_stdout() -> None:
    """Raises UsageError if stdout is closed."""
    if isinstance(sys.stdout, _ClosedReport):
        raise UsageError("stdout is closed; name OUT")


def _wrapped(stream: Any, kind: type[io.TextIOWrapper], closed: type[io.TextIOWrapper], number: int) -> Any:
    if stream is None:
        return closed(open(number, "wb", closefd=False), "utf-8", errors="replace")
    if type(stream) is not io.TextIOWrapper:
        return stream
    encoding, buffered = stream.encoding, stream.line_buffering
    stream.flush()
    # A locale that lacks × or δ is no reason to fail.
    return kind(stream.detach(), encoding, errors="replace", line_buffering=buffered)


class _Report(io.TextIOWrapper):
    """stdout."""

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError as error:
            self._fail(error)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError as error:
            self._fail(error)

    @staticmethod
    def _fail(error: OSError) -> NoReturn:
        drop(1)  # what is still to be flushed when the interpreter ends
        if isinstance(error, BrokenPipeError):
            raise error
        raise ReportError(f"stdout: {error.strerror or error}") from error


class _ClosedReport(_Report):
    """stdout that nobody sees."""


class _Complaints(io.TextIOWrapper):
    """stderr: there is nobody to tell that it cannot be written."""

    def write(self, text: str) -> int:
        with contextlib.suppress(OSError):
            return super().write(text)
        drop(2)
        return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError:
            drop(2)


class _ClosedInput(io.TextIOBase):
    """stdin that is closed."""

    @property
    def buffer(self) -> NoReturn:
        """Raises UsageError."""
        raise UsageError("stdin is closed; name IN")
