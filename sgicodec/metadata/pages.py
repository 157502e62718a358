"""Pages of a TIFF file: which of its directories hold pictures of their own, and the file as one of them has it."""

from __future__ import annotations

import itertools
import struct
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple, overload

from sgicodec.metadata import ifd
from sgicodec.metadata.filebytes import Bytes, FileBytes

_SUBFILE, _OLD_SUBFILE, _WIDTH, _HEIGHT, _DESCRIPTION, _TILE_WIDTH = 254, 255, 256, 257, 270, 322
_ASKED = (_SUBFILE, _OLD_SUBFILE, _WIDTH, _HEIGHT, _TILE_WIDTH)
_REDUCED, _MASK, _OLD_REDUCED = 1, 4, 2
_APERIO = b"Aperio"
_ASSOCIATED = {0: "thumbnail", 1: "label", 9: "macro"}
"""Aperio's pictures that are in strips, by their NewSubfileType."""


class Page(NamedTuple):
    """A directory: its number in the file, from 0, its offset, the size of its picture, whether that is in tiles, and
    what it is to others (the tag NewSubfileType).
    """

    number: int
    offset: int
    width: int = 0
    height: int = 0
    tiled: bool = False
    subfile: int = 0

    @property
    def is_mask(self) -> bool:
        """Whether it is a mask of another."""
        return self.subfile & _MASK > 0


def tiff_pages(data: Bytes) -> list[Page]:
    """The pages of a TIFF file. Reductions and masks of others are none, nor are the levels of a slide.

    Where nothing else is there, the first directory is one. A chain of directories that is damaged ends there.
    """
    spelling = ifd.layout(data)
    if spelling is None:
        return []
    directories = list(_directories(data, spelling))
    pages = [page for page, own in directories if own] or [page for page, _ in directories[:1]]
    return pages[:1] if _is_slide(data) or _are_levels(pages) else pages


def has_mask(data: Bytes) -> bool:
    """Whether one of the directories of a TIFF file is a mask of another."""
    spelling = ifd.layout(data)
    return spelling is not None and any(page.is_mask for page, _ in _directories(data, spelling))


def associated_images(data: Bytes) -> list[str]:
    """What Aperio's pictures beside a slide are called."""
    spelling = ifd.layout(data)
    if spelling is None or not _is_slide(data):
        return []
    others = (page for page, _ in _directories(data, spelling) if page.number and not page.tiled)
    return sorted(_ASSOCIATED.get(page.subfile, "another picture") for page in others)


def _directories(data: Bytes, spelling: ifd.Layout) -> Iterator[tuple[Page, bool]]:
    """Each directory of the chain, and whether it says nothing of being a part of another."""
    seen: set[int] = set()
    try:
        offset = ifd.first_directory(data, spelling)
        while offset and offset not in seen:
            seen.add(offset)
            found = ifd.rows(data, offset, spelling)
            values = {row.tag: ifd.first_integer(data, row, spelling) for row in found if row.tag in _ASKED}
            own = not values.get(_SUBFILE, 0) & (_REDUCED | _MASK) and values.get(_OLD_SUBFILE) != _OLD_REDUCED
            size = values.get(_WIDTH, 0), values.get(_HEIGHT, 0)
            yield Page(len(seen) - 1, offset, *size, _TILE_WIDTH in values, values.get(_SUBFILE, 0)), own
            end = offset + spelling.count.size + len(found) * spelling.row.size
            offset = ifd.offset(data, end, spelling)
    except struct.error:
        return


def _is_slide(data: Bytes) -> bool:
    """Whether the file is Aperio's: its levels follow each other like pages."""
    entry = ifd.entries(data, {_DESCRIPTION}).get(_DESCRIPTION)
    return entry is not None and entry.data.startswith(_APERIO)


def _are_levels(pages: list[Page]) -> bool:
    """Whether each is the one before in half its size or less: levels of a pyramid in tiles that are not marked so."""
    first = pages[0] if pages else Page(0, 0)
    scales = [max(1, round(first.width / max(1, page.width))) for page in pages]
    fit = (
        page.tiled and abs(page.width - first.width / scale) < 1 and abs(page.height - first.height / scale) < 1
        for page, scale in zip(pages, scales, strict=True)
    )
    return len(pages) > 1 and all(fit) and all(b >= 2 * a for a, b in itertools.pairwise(scales))


class PageBytes(FileBytes):
    """A TIFF file as if its header pointed at the directory of one page, for those who look at the first.

    whole: the file as it is.
    """

    def __init__(self, file: BinaryIO, page: Page) -> None:
        super().__init__(file)
        self.whole = FileBytes(file)
        spelling = ifd.layout(self.whole)
        if spelling is None:
            raise struct.error("not a TIFF structure")
        self._at, self._offset = spelling.first, spelling.offset.pack(page.offset)

    @overload
    def __getitem__(self, at: int) -> int: ...
    @overload
    def __getitem__(self, at: slice) -> bytes: ...
    def __getitem__(self, at: int | slice) -> int | bytes:
        found = super().__getitem__(at)
        start = at.indices(len(self))[0] if isinstance(at, slice) else at
        if isinstance(found, int) or not start <= self._at <= start + len(found) - len(self._offset):
            return found
        before = self._at - start
        return found[:before] + self._offset + found[before + len(self._offset) :]
