"""What a stream says before its tiles: header and metadata, and the bytes of each kind of chunk. No tile is read."""

from __future__ import annotations

from typing import BinaryIO

from sgicodec.bitstream.container import CHUNKS, SIGNATURE, Chunk, ChunkReader
from sgicodec.bitstream.header import Header, decode_header
from sgicodec.bitstream.index import TRAILER_BYTES, check_unlisted, index_offset
from sgicodec.bitstream.printable import printable
from sgicodec.errors import CorruptStreamError
from sgicodec.metadata.blobs import Metadata

__all__ = ["StreamSummary"]

_END_BYTES = 6


class StreamSummary:
    """header, blobs (payloads by letter, without T, X and o), size of the file, chunk_bytes: that of every chunk by its
    letter, frame included. A source that cannot seek is read to its end. Raises StreamError.
    """

    def __init__(self, source: bytes | BinaryIO) -> None:
        self._reader = ChunkReader(source, CHUNKS)
        self.blobs: dict[str, bytes] = {}
        self.chunk_bytes: dict[str, int] = {"signature": len(SIGNATURE)}
        self.header = self._read()
        self.size = self._reader.size or self._reader.end
        if "T" not in self.chunk_bytes:
            raise CorruptStreamError("there is no tile: nothing to draw")

    @property
    def metadata(self) -> Metadata:
        """What travels with the picture."""
        blobs = self.blobs
        return Metadata(icc=blobs.get("i"), exif=blobs.get("c"), xmp=blobs.get("x"), geo=blobs.get("g"))

    @property
    def has_overview(self) -> bool:
        """Whether the stream carries the picture in small."""
        return "o" in self.chunk_bytes

    @property
    def software(self) -> str:
        """What wrote the stream."""
        return printable(self.blobs.get("s", b""))

    def _read(self) -> Header:
        header: Header | None = None
        for chunk in self._reader:
            if chunk.kind == "T" and header is not None and header.tile and self._reader.size is not None:
                if self._jump(chunk, self._reader.size):
                    return header
                check_unlisted(header.grid.count)
            self.chunk_bytes[chunk.kind] = self.chunk_bytes.get(chunk.kind, 0) + chunk.end - chunk.offset
            if chunk.kind not in "TXo":
                self.blobs[chunk.kind] = chunk.payload()
                header = header or decode_header(self.blobs["H"])
        if header is None:
            raise CorruptStreamError("there is no header")
        return header

    def _jump(self, first: Chunk, size: int) -> bool:
        """Counts all tiles at once, from the first one to the index that the end of the file names, if it does."""
        offset = index_offset(self._reader.peek(max(0, size - TRAILER_BYTES), TRAILER_BYTES))
        if offset is None or not first.end <= offset < size:
            return False
        index = self._reader.chunk_at(offset)
        if index.kind != "X" or index.end != size - _END_BYTES:
            return False
        self.chunk_bytes |= {"T": offset - first.offset, "X": index.end - index.offset}
        return True
