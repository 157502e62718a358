"""Files behind URLs: opened by fsspec, read by ranges, and what their servers' failures are called."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import ssl
import tempfile
from collections.abc import Iterator
from http import HTTPStatus
from typing import Any, BinaryIO

from sgicodec.errors import MissingExtraError, SgiError, StreamError, require
from sgicodec.remote.range_file import RangeFile, Span

_AT_ONCE = 8
"""Requests to one server."""

_OF_NETWORK = (ConnectionError, socket.gaierror, ssl.SSLError)


def open_url(url: str, failure: type[SgiError] = StreamError) -> BinaryIO:
    """The file behind a URL, by fsspec, which can seek. Only what is read is fetched; where a server gives no ranges,
    the whole file is, into a temporary one.

    Raises `failure`, now or while reading, MissingExtraError where the library of its kind of URL is missing.
    """
    require("fsspec", f"{url}: opening URLs", "remote")
    import fsspec

    with naming_url(url, failure):
        system, path = fsspec.url_to_fs(url)
        file = system.open(path, "rb", cache_type="none")
        source = _Source(url, failure, system, path, file)
        return source.opened()


class _Source:
    """Where the parts of a file come from: its server, or a copy of all of it."""

    def __init__(self, url: str, failure: type[SgiError], system: Any, path: str, file: Any) -> None:
        self._url, self._failure, self._system, self._path, self._file = url, failure, system, path, file
        self._is_copy = self._gives_parts = False

    def opened(self) -> BinaryIO:
        try:
            size = self._file.seek(0, 2)
        except (ValueError, OSError):  # it only streams
            self._take_copy()
            size = self._file.seek(0, 2)
        return RangeFile(size, self._fetch, lambda: self._file.close())  # type: ignore[return-value]

    def _fetch(self, spans: list[Span]) -> list[bytes]:
        with naming_url(self._url, self._failure):
            if len(spans) > 1 and self._gives_parts and self._system.async_impl:
                found = self._together(spans)
            else:
                found = [self._part(start, stop) for start, stop in spans]
            for (start, stop), data in zip(spans, found, strict=True):
                if len(data) != stop - start:
                    raise self._failure(f"{self._url}: {len(data)} bytes came where {stop - start} were asked for")
            return found

    def _together(self, spans: list[Span]) -> list[bytes]:
        starts, stops = ([span[side] for span in spans] for side in range(2))
        paths = [self._path] * len(spans)
        return list(self._system.cat_ranges(paths, starts, stops, batch_size=_AT_ONCE, on_error="raise"))

    def _part(self, start: int, stop: int) -> bytes:
        try:
            data = self._read(start, stop)
            self._gives_parts = not self._is_copy
        except ValueError:  # by which fsspec says that the server does not give ranges
            self._take_copy()
            data = self._read(start, stop)
        return data

    def _read(self, start: int, stop: int) -> bytes:
        self._file.seek(start)
        return bytes(self._file.read(stop - start))

    def _take_copy(self) -> None:
        """Replaces the file by a temporary one with all of it."""
        self._file.close()
        copy = tempfile.TemporaryFile(prefix="sgicodec-")  # noqa: SIM115 (closed with the file)
        try:
            with self._system.open(self._path, "rb", block_size=0) as stream:
                shutil.copyfileobj(stream, copy)
        except BaseException:
            copy.close()
            raise
        self._file = copy
        self._is_copy, self._gives_parts = True, False


@contextlib.contextmanager
def naming_url(url: str, failure: type[SgiError]) -> Iterator[None]:
    """Turns whatever a file system raises into `failure` with the URL; they have no errors in common."""
    try:
        yield
    except (SgiError, MemoryError):
        raise
    except ImportError as error:
        raise MissingExtraError(f"{url}: {error}") from error
    except FileNotFoundError as error:
        raise failure(f"{url}: {_unreachable(error.__cause__) or 'there is no such file'}") from error
    except Exception as error:
        text = _unreachable(error) or getattr(error, "strerror", None) or str(error) or type(error).__name__
        raise failure(f"{url}: {' '.join(str(text).split())}") from error


def _unreachable(error: BaseException | None) -> str:
    """What keeps a server from giving a file, by what fsspec's FileNotFoundError hides, or any other error; empty where
    it is not the server.
    """
    if isinstance(error, FileNotFoundError):
        return _unreachable(error.__cause__)
    status = getattr(error, "status", None)  # of an answer by HTTP
    if status == 0:  # which only an end without an answer has
        return "its server redirects from one address to the next"
    if isinstance(status, int):
        phrase = next((known.phrase for known in HTTPStatus if known == status), "")
        return "" if status in (404, 410) else f"its server answers {status} {phrase}".rstrip()
    if isinstance(error, TimeoutError):
        return "its server does not answer in time"
    if isinstance(error, _OF_NETWORK) or type(error).__module__.startswith("aiohttp"):
        return f"its server cannot be reached: {_reason(getattr(error, 'os_error', error))}"
    return ""


def _reason(error: Any) -> str:
    """In the words of the system where asyncio has its own; names and certificates have other numbers than it."""
    number = getattr(error, "errno", None) or 0
    if number > 0 and not isinstance(error, ssl.SSLError):
        return os.strerror(number)
    return str(getattr(error, "strerror", None) or error) or type(error).__name__
