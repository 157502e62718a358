"""What a stream says before its tiles: header and metadata, and the bytes of each kind of chunk. No tile is read."""

from __future__ import annotations

from typing import BinaryIO

from sgicodec import _native
from sgicodec.bitstream.chunks import metadata_of
from sgicodec.bitstream.header import decode_header
from sgicodec.bitstream.printable import printable
from sgicodec.metadata.blobs import Metadata

__all__ = ["StreamSummary"]


class StreamSummary:
    """header, blobs (payloads by letter, without T, X, o and r), size of the file, chunk_bytes: that of every chunk by
    its letter, frame included. A source that cannot seek is read to its end. Raises StreamError.
    """

    def __init__(self, source: bytes | BinaryIO) -> None:
        self.blobs: dict[str, bytes]
        self.chunk_bytes: dict[str, int]
        self.size: int
        self.has_exact_views: bool
        self.blobs, self.chunk_bytes, self.size, max_error, self.has_exact_views, has_cells = _native.summarize(source)
        self.max_error: float | None = None if max_error < 0 or has_cells else max_error
        """As in `Stream`."""
        self.graphics_error: float | None = max_error if has_cells else None
        """As in `Stream`."""
        self.header = decode_header(self.blobs["H"])

    @property
    def metadata(self) -> Metadata:
        """What travels with the picture."""
        return metadata_of(self.blobs)

    @property
    def has_overview(self) -> bool:
        """Whether the stream carries the picture in small."""
        return "o" in self.chunk_bytes

    @property
    def software(self) -> str:
        """What wrote the stream."""
        return printable(self.blobs.get("s", b""))
