"""The boxes of which AVIF, JPEG XL and JPEG 2000 files consist (ISO/IEC 14496-12)."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from sgicodec.metadata.filebytes import Bytes


def boxes(data: Bytes, within: slice) -> Iterator[tuple[bytes, slice]]:
    """Kind and contents of each box. Raises struct.error for one that ends outside."""
    at = within.start
    while at < within.stop:
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        start = at + 8
        if length == 1:
            (length,) = struct.unpack(">Q", data[start : start + 8])
            start += 8
        end = at + length if length else within.stop
        if not start <= end <= within.stop:
            raise struct.error("a box ends outside of its own")
        yield kind, slice(start, end)
        at = end
