"""EXIF blobs that follow their picture: turned upright, so that no copy of its orientation turns it again, and what a
view shows of it.
"""

from __future__ import annotations

import struct

from sgicodec.metadata import ifd, slides
from sgicodec.metadata.motion import Motion

PREFIX = b"Exif\0\0"
"""What stands before the blob in JPEG, and in other files by mistake."""

_ASCII, _SHORT, _LONG, _RATIONAL = 2, 3, 4, 5
_FORMS = {1: "B", _SHORT: "H", _LONG: "I"}
_DESCRIPTION, _ORIENTATION = 270, 274
_DIRECTORIES = (ifd.EXIF_IFD, ifd.INTEROP_IFD)

_SIZES = ((256, 257), (40962, 40963), (4097, 4098))
_RATIOS = ((282, 283), (41486, 41487))
_AREAS = (37396, 41492)
"""Width and height of the picture (of the image, PixelDimension, of the related image); pixels per unit across and
down (of the picture, of the focal plane); area and place of the subject.
"""


def plain(blob: bytes) -> bytes | None:
    """The blob without a prefix; None if it is no TIFF structure with a directory."""
    blob = blob.removeprefix(PREFIX)
    return blob if _Blob.of(blob) is not None else None


def orientation(blob: bytes | None) -> int | None:
    """The orientation that it states, 1 to 8; None if it says nothing of it."""
    found = None if blob is None else _Blob.of(blob)
    values = None if found is None else found.integers(_ORIENTATION)
    return None if values is None else values[0] if values[0] in range(1, 9) else 1


def size(blob: bytes | None) -> tuple[int, int] | None:
    """Width and height of the picture, if it states both."""
    found = None if blob is None else _Blob.of(blob)
    pairs = () if found is None else ((found.integers(x), found.integers(y)) for x, y in _SIZES[1::-1])
    return next(((across[0], down[0]) for across, down in pairs if across and down), None)


def upright(blob: bytes) -> bytes | None:
    """The blob without a prefix and with its orientation set to 1; None if it holds nothing else.

    The value is changed where it stands: maker notes hold offsets that would not survive a rewrite.
    """
    found = _Blob.of(blob.removeprefix(PREFIX))
    if found is None:
        return None
    for row in found.directories[0].rows:
        if row.tag == _ORIENTATION:
            struct.pack_into(found.order + "HIHH", found.data, row.at - 6, _SHORT, 1, 1, 0)
    return bytes(found.data) if any(row.tag != _ORIENTATION for row in found.directories[0].rows) else None


def moved(blob: bytes, motion: Motion) -> bytes:
    """The blob of a picture whose pixels moved: sizes, pixels per unit and places that it states are changed where they
    stand; those that cannot be are taken out.
    """
    found = None if motion.is_none else _Blob.of(blob)
    if found is None:
        return blob
    for across, down in _SIZES:
        found.change_sizes(across, down, motion)
    for across, down in _RATIOS:
        found.change_ratios(across, down, motion)
    for tag in _AREAS:
        values = found.integers(tag)
        if values is not None:
            found.change(tag, motion.area(values))
    found.change_description(motion)
    return bytes(found.data)


class _Directory:
    """Where a directory stands, and its rows."""

    def __init__(self, data: bytes | bytearray, at: int, spelling: ifd.Layout) -> None:
        self.at, self.rows = at, ifd.rows(bytes(data), at, spelling)


class _Blob:
    """A blob that is changed in place: all its directories but that of the thumbnail."""

    def __init__(self, blob: bytes, spelling: ifd.Layout) -> None:
        self.data, self.order, self._spelling = bytearray(blob), spelling.order, spelling
        self.directories = [_Directory(blob, ifd.first_directory(blob, spelling), spelling)]
        for pointer in _DIRECTORIES:
            offset = self.integers(pointer)
            try:
                if offset is not None:
                    self.directories.append(_Directory(blob, offset[0], spelling))
            except struct.error:  # damaged: it stays as it is
                pass

    @classmethod
    def of(cls, blob: bytes) -> _Blob | None:
        """None for what is no TIFF structure with a directory."""
        spelling = ifd.layout(blob)
        try:
            return None if spelling is None or spelling.big else cls(blob, spelling)
        except struct.error:
            return None

    def _find(self, tag: int) -> tuple[_Directory, ifd.Row] | None:
        return next(((part, row) for part in self.directories for row in part.rows if row.tag == tag), None)

    def _offset(self, row: ifd.Row, length: int) -> int | None:
        """Where the values of a row stand, of so many bytes; None for outside."""
        at = row.at if length <= 4 else int(self._spelling.offset.unpack_from(self.data, row.at)[0])
        return at if at + length <= len(self.data) else None

    def integers(self, tag: int) -> list[int] | None:
        """Up to four of its values; None where there are none, or others."""
        found = self._find(tag)
        if found is None or found[1].kind not in _FORMS or not 1 <= found[1].values <= 4:
            return None
        form = f"{self.order}{found[1].values}{_FORMS[found[1].kind]}"
        at = self._offset(found[1], struct.calcsize(form))
        return None if at is None else list(struct.unpack_from(form, self.data, at))

    def change_sizes(self, across: int, down: int, motion: Motion) -> None:
        """Width and height; where one is missing the other follows the picture's."""
        width, height = self.integers(across), self.integers(down)
        new = motion.size_of_all(*((width or [motion.width])[0], (height or [motion.height])[0]))
        for tag, old, value in ((across, width, new[0]), (down, height, new[1])):
            if old is not None:
                self.change(tag, [value])

    def change_ratios(self, across: int, down: int, motion: Motion) -> None:
        """Pixels per unit; one that stands alone is taken out if what was across is down now."""
        offsets = [self._ratio_at(tag) for tag in (across, down)]
        pair = struct.Struct(self.order + "II")
        if motion.is_sideways and None in offsets:
            for tag in (across, down):
                self.change(tag, None)
            return
        old = [(0, 0) if at is None else pair.unpack_from(self.data, at) for at in offsets]
        for at, ratio in zip(offsets, motion.ratios(old[0], old[1]), strict=True):
            if at is not None:
                pair.pack_into(self.data, at, *ratio)

    def _ratio_at(self, tag: int) -> int | None:
        found = self._find(tag)
        is_ratio = found is not None and found[1].kind == _RATIONAL and found[1].values == 1
        return self._offset(found[1], 8) if found is not None and is_ratio else None

    def change_description(self, motion: Motion) -> None:
        """That of a slide, whose pixels have another size now. A longer text stands behind all else."""
        found = self._find(_DESCRIPTION)
        at = None if found is None else self._offset(found[1], found[1].values)
        if found is None or at is None or found[1].kind != _ASCII or found[1].values <= 4:
            return
        old = bytes(self.data[at : at + found[1].values])
        text = slides.scaled(old, motion.scale_x, motion.scale_y)
        if len(text) > len(old):
            at = len(self.data) + len(self.data) % 2
            self.data += bytes(at - len(self.data)) + text
        else:
            self.data[at : at + len(old)] = text.ljust(len(old), b"\0")
        struct.pack_into(self.order + "II", self.data, found[1].at - 4, max(len(text), 5), at)

    def change(self, tag: int, values: list[int] | None) -> None:
        """Write as many integers as there are, or take the tag out. One that is too large becomes wider."""
        found = self._find(tag)
        if found is None:
            return
        part, row = found
        kind = row.kind
        if values is not None and kind in _FORMS and max(values) >= 1 << 8 * struct.calcsize(_FORMS[kind]):
            kind = _LONG
        form = f"{self.order}{row.values}{_FORMS.get(kind, 'I')}"
        at = self._offset(row, struct.calcsize(form))
        if values is None or at is None or (kind != row.kind and len(values) > 1):
            self._take_out(part, row)
            return
        struct.pack_into(self.order + "H", self.data, row.at - 6, kind)
        struct.pack_into(form, self.data, at, *values)

    def _take_out(self, part: _Directory, row: ifd.Row) -> None:
        """The rows behind it, and the offset of the next directory, move up; all else stays where it is."""
        size, start = self._spelling.row.size, row.at - 8
        end = part.at + 2 + len(part.rows) * size + 4
        self.data[start:end] = self.data[start + size : end] + bytes(size)
        struct.pack_into(self.order + "H", self.data, part.at, len(part.rows) - 1)
        part.rows = ifd.rows(bytes(self.data), part.at, self._spelling)
