"""What is served: names in URLs to files, and to none besides."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from sgicodec.bitstream.recognition import looks_like_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import StreamError, UsageError
from sgicodec.server.refusal import Refusal

_SUFFIX = ".sgi"
_MAX_LISTED = 2000
"""Names that one listing shows."""


class ListedStream(NamedTuple):
    """name: of the file; bytes: its size; size: width and height in pixels, None where the stream is damaged;
    has_overview: whether it carries the picture in small.
    """

    name: str
    bytes: int
    size: tuple[int, int] | None
    has_overview: bool


class Listing(NamedTuple):
    """Names of folders, streams, and whether there are more than these."""

    folders: list[str]
    streams: list[ListedStream]
    cut: bool


class Folder:
    """The streams in a folder and its subfolders, by suffix and first bytes. Links that lead out of it, and names that
    begin with a dot, do not exist.
    """

    def __init__(self, root: Path) -> None:
        try:
            self.root = root.resolve(strict=True)
        except (OSError, RuntimeError, ValueError) as error:
            raise UsageError(f"{root}: {getattr(error, 'strerror', None) or error}") from error
        if not self.root.is_dir():
            raise UsageError(f"{root} is no folder; sgi view shows a file")

    def find(self, name: str) -> Path:
        """The file of that name. Raises Refusal."""
        path = self._inside(name)
        if path.suffix.lower() != _SUFFIX or not _is_stream(path):
            raise _absent(name)
        return path

    def has_folder(self, name: str) -> bool:
        """Whether there is a folder of that name."""
        try:
            return self._inside(name).is_dir()
        except Refusal:
            return False

    def listing(self, name: str) -> Listing:
        """What lies in the folder of that name; "" is the top. Raises Refusal."""
        folder = self._inside(name) if name else self.root
        folders: list[str] = []
        streams: list[ListedStream] = []
        try:
            for path in sorted(folder.iterdir()):
                if len(folders) + len(streams) == _MAX_LISTED:
                    return Listing(folders, streams, True)
                if path.name.startswith(".") or not _printable(path.name) or not self._holds(path):
                    continue
                if path.is_dir():
                    folders.append(path.name)
                elif path.suffix.lower() == _SUFFIX and _is_stream(path):
                    streams.append(_listed(path.name, path))
        except OSError:
            raise _absent(name) from None
        return Listing(folders, streams, False)

    def _holds(self, path: Path) -> bool:
        """Whether it lies inside, its links followed; links in a circle lie nowhere."""
        try:
            return path.resolve().is_relative_to(self.root)
        except (OSError, RuntimeError):
            return False

    def _inside(self, name: str) -> Path:
        """The file or folder, without links. Raises Refusal for one that is outside or is not there."""
        parts = name.split("/")
        if any(part.startswith(".") or not part or "\\" in part or "\0" in part for part in parts):
            raise _absent(name)
        try:
            path = self.root.joinpath(*parts).resolve(strict=True)
        except (OSError, RuntimeError, ValueError):
            raise _absent(name) from None
        if not path.is_relative_to(self.root):
            raise _absent(name)
        return path


class ListedFiles:
    """Files that were named one by one, wherever they lie."""

    def __init__(self, files: dict[str, Path]) -> None:
        self._files = files

    def find(self, name: str) -> Path:
        """As that of `Folder`."""
        if name not in self._files or not self._files[name].is_file():
            raise _absent(name)
        return self._files[name]

    def has_folder(self, name: str) -> bool:
        """As that of `Folder`."""
        return False

    def listing(self, name: str) -> Listing:
        """As that of `Folder`."""
        if name:
            raise _absent(name)
        return Listing([], [_listed(each, self._files[each]) for each in sorted(self._files)], False)


Catalog = Folder | ListedFiles
"""Where files come from."""


def _listed(name: str, path: Path) -> ListedStream:
    """A stream with what its header says. Raises OSError."""
    try:
        with open_stream(path) as found:
            return ListedStream(name, found.size, (found.width, found.height), found.has_overview)
    except StreamError:
        return ListedStream(name, path.stat().st_size, None, False)


def _is_stream(path: Path) -> bool:
    """Whether a file begins as streams do: others share their suffix."""
    return path.is_file() and looks_like_stream(path)


def _printable(name: str) -> bool:
    """Whether a name can stand in a URL: bytes that are no UTF-8 cannot, nor line breaks, which no route has."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return "\n" not in name


def _absent(name: str) -> Refusal:
    return Refusal(404, f"there is no {name[:200]!r} here")
