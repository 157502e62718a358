"""A picture read window by window, whether it is in memory or in a file."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from sgicodec.encoder.plan import Plan, Shape
from sgicodec.errors import UsageError
from sgicodec.picture import Picture

if TYPE_CHECKING:
    from sgicodec.image import Source

__all__ = ["Windows", "kept", "tile_window", "windows_of"]

_BLOCK = 1 << 20


class Windows(Protocol):
    """What an encode asks of a picture. Windows are asked for in rows, from the top down."""

    @property
    def shape(self) -> Shape:
        """What it is."""

    @property
    def page(self) -> int | None:
        """Which page of its file it is, where that was asked for."""

    def read(self, x: int, y: int, width: int, height: int) -> Picture:
        """The pixels of a window whose first pixel is (x, y). Raises PictureError."""

    def memory(self, width: int, height: int) -> int:
        """Bytes that reading windows of this size takes at most."""

    def digest(self) -> bytes:
        """32 bytes that change with any pixel."""


def windows_of(picture: Picture | Source) -> Windows:
    """The windows of a picture in memory, or of an opened one. Raises UsageError for what is neither."""
    if isinstance(picture, Picture):
        return _PictureWindows(picture)
    if not hasattr(picture, "header"):
        raise UsageError(f"{type(picture).__name__} is no Picture, nor opened by open_source; encode takes arrays")
    return _SourceWindows(picture)


def tile_window(windows: Windows, plan: Plan, number: int) -> Picture:
    """What a tile covers."""
    return plan.of_header(windows.read(*plan.header.grid.rect(number)))


def kept(windows: Windows) -> Windows:
    """The same, read whole when a window is first asked for, and then kept."""
    return windows if isinstance(windows, _PictureWindows) else _Kept(windows)


class _PictureWindows:
    page = None

    def __init__(self, picture: Picture) -> None:
        self._picture, self.shape = picture, Shape.of(picture)

    def read(self, x: int, y: int, width: int, height: int) -> Picture:
        return replace(self._picture, pixels=self._picture.pixels[y : y + height, x : x + width])

    def memory(self, width: int, height: int) -> int:
        return 0

    def digest(self) -> bytes:
        found = hashlib.sha256()
        for row in self._picture.pixels:
            found.update(row.tobytes())
        return found.digest()


class _Kept:
    def __init__(self, windows: Windows) -> None:
        self._windows, self.shape, self.page = windows, windows.shape, windows.page
        self.memory, self.digest = windows.memory, windows.digest

    @cached_property
    def _picture(self) -> Picture:
        return self._windows.read(0, 0, self.shape.width, self.shape.height)

    def read(self, x: int, y: int, width: int, height: int) -> Picture:
        return replace(self._picture, pixels=self._picture.pixels[y : y + height, x : x + width])


class _SourceWindows:
    """All samples are read once more where their range is not known."""

    def __init__(self, source: Source) -> None:
        self._source, header, use = source, source.header, source.use
        self.shape = Shape(
            source.width,
            source.height,
            source.channels,
            header.count,
            source.dtype,
            use.sample_range,
            source.metadata,
            source.nodata,
            use.exact,
            use.eight_bits,
            use.remark,
        )
        self.read, self.memory, self.page = source.read, source.memory, source.page

    def digest(self) -> bytes:
        found = hashlib.sha256(b"" if self.page is None else b"page %d" % self.page)
        with Path(self._source.path).open("rb") as file:
            while block := file.read(_BLOCK):
                found.update(block)
        return found.digest()
