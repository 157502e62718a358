"""Writing to URLs: a file is made on this machine, then sent, and appears whole or not at all."""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

from sgicodec.errors import SgiError, UsageError, require
from sgicodec.remote.url import file_name, is_url, naming_url

__all__ = ["Upload", "check_writable", "is_there", "local_file", "send"]

_READ_ONLY = ("http", "https", "data", "github", "git", "zip", "tar", "libarchive", "reference")
"""Kinds of URL whose file systems do not write, or write whole archives only."""


def check_writable(url: str) -> None:
    """Raises UsageError for a kind of URL that can be read only, MissingExtraError without fsspec."""
    require("fsspec", f"{url}: writing to URLs", "remote")
    kind = re.split("::|://", url)[0].lower()
    if "::" in url or kind in _READ_ONLY:
        kind = "a chain of file systems" if "::" in url else f"{kind}://"
        raise UsageError(f"{url}: {kind} can be read, not written; name a file, or a URL such as s3://")


def is_there(url: str, failure: type[SgiError]) -> bool:
    """Whether there is such a file. Raises `failure` where that cannot be found out, and as `check_writable`."""
    check_writable(url)
    import fsspec

    with naming_url(url, failure):
        system, path = fsspec.url_to_fs(url)
        system.invalidate_cache()
        return bool(system.exists(path))


def send(path: Path, url: str, failure: type[SgiError]) -> None:
    """Copies a file to a URL, where it appears when all of it is there; till then what was there stays.

    Raises `failure`, UsageError as `check_writable`.
    """
    check_writable(url)
    import fsspec

    with naming_url(url, failure, "there is no such place"):
        # A transaction belongs to its file system, which others would share.
        system, place = fsspec.url_to_fs(url, skip_instance_cache=True)
        with path.open("rb") as file, system.transaction, system.open(place, "wb") as sent:
            shutil.copyfileobj(file, sent, 1 << 20)


class Upload:
    """A file that is made at `path`, in a temporary folder, and sent to `url` by `send`. A context manager: leaving it
    removes the file, unless it could not be sent.
    """

    def __init__(self, url: str, failure: type[SgiError]) -> None:
        """Raises as `check_writable`."""
        check_writable(url)
        self._url, self._failure, self._is_kept = url, failure, False
        self._folder = Path(tempfile.mkdtemp(prefix="sgicodec-upload-"))
        self.path = self._folder / file_name(url)

    def __enter__(self) -> Upload:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._is_kept:
            shutil.rmtree(self._folder, ignore_errors=True)

    def send(self) -> None:
        """Raises `failure` with the place where the file is kept, if it could not be sent."""
        try:
            send(self.path, self._url, self._failure)
        except SgiError as error:
            self._is_kept = True
            raise type(error)(f"{error}; the file is kept in {self.path}") from error


@contextlib.contextmanager
def local_file(target: str | Path, failure: type[SgiError]) -> Iterator[Path]:
    """Where to write what is to go to `target`: that itself, or of a URL a file which is sent after the block. Raises
    `failure` if it cannot be sent.
    """
    if not isinstance(target, str) or not is_url(target):
        yield Path(target)
        return
    with Upload(target, failure) as upload:
        yield upload.path
        upload.send()
