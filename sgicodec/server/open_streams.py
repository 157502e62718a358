"""The streams that are open: as many as are allowed, those that were used last."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sgicodec.device import Device
from sgicodec.errors import StreamError

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream

Identity = tuple[str, int, int, int]
"""Path, time of the last change, bytes, inode: a file that is written anew is another one."""


def identity(path: Path) -> Identity:
    """That of a file. Raises OSError."""
    found = os.stat(path)
    return str(path), found.st_mtime_ns, found.st_size, found.st_ino


@dataclass
class _Entry:
    stream: Stream
    users: int = 0


class OpenStreams:
    """At most `most` streams, and those that are in use. Safe for use by several threads."""

    def __init__(self, most: int, device: Device) -> None:
        self._most, self._device = most, device
        self._lock = threading.Lock()
        self._entries: OrderedDict[Identity, _Entry] = OrderedDict()

    def __len__(self) -> int:
        return len(self._entries)

    @contextmanager
    def opened(self, path: Path) -> Iterator[Stream]:
        """The stream in a file. Raises StreamError, whose text does not name the path."""
        entry = self._take(path)
        try:
            yield entry.stream
        finally:
            with self._lock:
                entry.users -= 1
                self._release()

    def close(self) -> None:
        """Closes all."""
        with self._lock:
            for entry in self._entries.values():
                entry.stream.close()
            self._entries.clear()

    def _take(self, path: Path) -> _Entry:
        from sgicodec.decoder.stream import open_stream

        with self._lock:
            try:
                key = identity(path)
                if key not in self._entries:
                    self._entries[key] = _Entry(open_stream(path, self._device))
            except OSError as error:
                raise StreamError(error.strerror or str(error)) from error
            except StreamError as error:
                raise type(error)(str(error).removeprefix(f"{path}: ")) from error
            self._entries.move_to_end(key)
            self._entries[key].users += 1
            return self._entries[key]

    def _release(self) -> None:
        """Closes what is too many and not in use, that first which was not used for longest."""
        for key in [key for key, entry in self._entries.items() if not entry.users]:
            if len(self._entries) <= self._most:
                return
            self._entries.pop(key).stream.close()
