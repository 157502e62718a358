"""Files behind URLs, passed on in parts: for pages that may not read them because their servers do not allow it."""

from __future__ import annotations

import re
import threading
from collections.abc import Mapping
from typing import BinaryIO

from sgicodec.remote.remote_file import open_url
from sgicodec.server.refusal import Refusal

_MAX_ANSWER = 1 << 26
"""Bytes of one answer."""


class RemoteFiles:
    """Opens each URL when it is asked for. Safe for use by several threads, which take turns."""

    def __init__(self, urls: Mapping[str, str]) -> None:
        self._urls = urls
        self._files: dict[str, BinaryIO] = {}
        self._lock = threading.Lock()

    def read(self, name: str, asked: str | None) -> tuple[bytes, str]:
        """The part that a header Range asks for, and what Content-Range says of it. Raises Refusal, and StreamError for
        a URL that cannot be read.
        """
        if name not in self._urls:
            raise Refusal(404, f"there is no {name[:200]!r} here")
        found = re.fullmatch(r"bytes=(\d{1,18})-(\d{0,18})", asked or "")
        if found is None:
            raise Refusal(400, "ask for one part, with a header like Range: bytes=0-65535")
        with self._lock:
            if name not in self._files:
                self._files[name] = open_url(self._urls[name])
            file = self._files[name]
            size, start = file.seek(0, 2), int(found[1])
            stop = min(size, int(found[2]) + 1 if found[2] else size)
            if start >= stop:
                raise Refusal(416, f"the file has {size} bytes")
            if stop - start > _MAX_ANSWER:
                raise Refusal(400, f"{stop - start} bytes are more than this server passes on at once, {_MAX_ANSWER}")
            file.seek(start)
            return file.read(stop - start), f"bytes {start}-{stop - 1}/{size}"

    def close(self) -> None:
        """Closes all."""
        with self._lock:
            for file in self._files.values():
                file.close()
            self._files.clear()
