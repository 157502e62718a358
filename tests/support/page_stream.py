"""The chunks of a stream, read as docs/format.md says: what the native reader is compared with."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from page_chunks import CHUNKS, Chunk, ChunkReader
from page_header import decode_header
from page_varint import MAX_VARINT_BYTES, decode_varint, decode_varints

from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.header import Header
from sgicodec.errors import CorruptStreamError, LimitError

__all__ = ["TRAILER_BYTES", "StreamReader", "StreamSummary", "decode_index", "index_offset"]

_NUMBER_BYTES = 9
"""Of a varint."""

_END = bytes.fromhex("4500bfa9d7cc")
"""Chunk E."""

_OFFSET_BYTES, _CRC_BYTES = 8, 4
TRAILER_BYTES = _OFFSET_BYTES + _CRC_BYTES + len(_END)
"""Of a file with an index: where the index begins, its CRC, the end mark."""


_MOST_UNLISTED = 1 << 15
"""Tiles that are looked for one by one in a file without an index; every encoder writes one."""


def decode_index(payload: bytes, count: int) -> NDArray[np.int64]:
    """Offset and length of the `count` tiles [count, 2]. Raises CorruptStreamError."""
    fields = decode_varints(payload[: max(0, len(payload) - _OFFSET_BYTES)])
    if len(payload) < _OFFSET_BYTES or len(fields) != 2 * count + 1 or fields[0] != count:
        raise CorruptStreamError(f"index: it does not list the {count} tiles; the file is damaged")
    return fields[1:].reshape(count, 2)


def check_unlisted(count: int) -> None:
    """Raises LimitError if n tiles are too many for a file without an index."""
    if count > _MOST_UNLISTED:
        raise LimitError(f"there are {count} tiles and no sound index; at most {_MOST_UNLISTED} are sought without one")


def longest_index(count: int) -> int:
    """Bytes that the payload of an index of n tiles cannot exceed."""
    return _OFFSET_BYTES + MAX_VARINT_BYTES * (2 * count + 1)


def index_offset(tail: bytes) -> int | None:
    """Where the index of a file that ends in these `TRAILER_BYTES` begins, if it has one."""
    if len(tail) != TRAILER_BYTES or not tail.endswith(_END):
        return None
    return int.from_bytes(tail[:_OFFSET_BYTES], "little")


def tile_number(header: Header, start: bytes) -> int:
    """The number of the tile whose payload begins so. Raises CorruptStreamError."""
    number = decode_varint(start, 0)[0] if header.tile else 0
    if number >= header.grid.count:
        raise CorruptStreamError(f"tile {number} in a stream of {header.grid.count}")
    return number


class StreamReader:
    """Reads all but the tiles. Those are found by the index of a source that can seek, else by reading on; one that
    cannot seek is read to its end, its compressed tiles kept.

    header, blobs (payloads by letter, without T, X and o), size of the file, chunk_bytes: that of every chunk by its
    letter, frame included. An overview in an overview is passed over: `is_overview`. Raises StreamError.
    """

    def __init__(self, source: bytes | BinaryIO, is_overview: bool = False) -> None:
        self._reader = ChunkReader(source, CHUNKS.replace("o", "") if is_overview else CHUNKS)
        self.blobs: dict[str, bytes] = {}
        self.chunk_bytes: dict[str, int] = {"signature": len(SIGNATURE)}
        self._places: NDArray[np.int64] | None = None
        """Offset and length of each tile [n, 2], offset -1 where there is none: of its chunk, or in `_kept`."""
        self._kept = bytearray()
        """The payloads of what is no seekable stream of several tiles: memory is taken for bytes alone."""
        self._overview: Chunk | bytes | None = None
        self.header = self._read()
        self.size = self._reader.size or self._reader.end
        if self._places is None:
            raise CorruptStreamError("there is no tile: nothing to draw")
        missing = np.flatnonzero(self._places[:, 0] < 0)
        if len(missing):
            count = self.header.grid.count
            raise CorruptStreamError(f"{count - len(missing)} of {count} tiles are there; tile {missing[0]} is missing")

    @property
    def has_overview(self) -> bool:
        """Whether there is one, sound or not."""
        return self._overview is not None

    def overview(self) -> bytes | None:
        """The stream that shows the picture in small, if there is one. Raises CorruptStreamError."""
        return self._overview.payload() if isinstance(self._overview, Chunk) else self._overview

    def tile(self, number: int) -> bytes:
        """The payload of a tile's chunk. Raises CorruptStreamError."""
        offset, length = (-1, 0) if self._places is None else self._places[number].tolist()
        if not self._lasting(self.header):
            return bytes(self._kept[offset : offset + length])
        chunk = self._reader.chunk_at(offset)
        if chunk.kind != "T" or chunk.length != length:
            raise CorruptStreamError(f"index: {chunk} is not tile {number}; the file is damaged")
        payload = chunk.payload()
        if tile_number(self.header, payload) != number:
            raise CorruptStreamError(f"index: {chunk} is another tile than {number}; the file is damaged")
        return payload

    def _read(self) -> Header:
        header: Header | None = None
        for chunk in self._reader:
            if chunk.kind == "T" and header is not None:
                if self._places is None and self._read_index(header):
                    return header
                if self._lasting(header):
                    check_unlisted(header.grid.count)
                self._note(header, chunk)
            elif chunk.kind == "X" and header is not None and header.tile:
                chunk.check()
            elif self._is_late(chunk, header):
                raise CorruptStreamError(f"{chunk}: there may be only one, before the tiles")
            elif chunk.kind == "o":
                self._overview = chunk if self._reader.size is not None else chunk.payload()
            else:
                self.blobs[chunk.kind] = chunk.payload()
                header = decode_header(self.blobs["H"])
            if chunk.kind not in "TX":
                self._count(chunk)
        if header is None:
            raise CorruptStreamError("there is no header")
        return header

    def _is_late(self, chunk: Chunk, header: Header | None) -> bool:
        """Whether it is a second one, or behind a tile of several."""
        again = chunk.kind in self.blobs or chunk.kind == "X" or (chunk.kind == "o" and self.has_overview)
        return again or bool(header and header.tile and self._places is not None)

    def _count(self, chunk: Chunk) -> None:
        self.chunk_bytes[chunk.kind] = self.chunk_bytes.get(chunk.kind, 0) + chunk.end - chunk.offset

    def _lasting(self, header: Header) -> bool:
        """Whether tiles can be read when they are wanted."""
        return header.tile > 0 and self._reader.size is not None

    def _note(self, header: Header, chunk: Chunk) -> None:
        """Remembers a tile that was come across."""
        lasting = self._lasting(header)
        if lasting:
            start = self._reader.peek(chunk.offset + len(chunk.head), min(_NUMBER_BYTES, chunk.length))
        else:
            start = chunk.payload()
        number = tile_number(header, start)
        if self._places is None:
            self._places = np.full((header.grid.count, 2), -1, np.int64)
        if self._places[number, 0] >= 0:
            raise CorruptStreamError(f"{chunk}: there may be only one tile {number}")
        self._places[number] = chunk.offset if lasting else len(self._kept), chunk.length
        if not lasting:
            self._kept += start
        self._count(chunk)

    def _read_index(self, header: Header) -> bool:
        """Looks for an index at the end of the file; True if it gives the places of the tiles."""
        size = self._reader.size
        if not header.tile or size is None:
            return False
        offset = index_offset(self._reader.peek(max(0, size - TRAILER_BYTES), TRAILER_BYTES))
        if offset is None or not len(SIGNATURE) < offset < size:
            return False
        chunk = self._reader.chunk_at(offset)
        if chunk.kind != "X" or chunk.end != size - 6 or chunk.length > longest_index(header.grid.count):
            return False
        self._places = decode_index(chunk.payload(), header.grid.count)
        self.chunk_bytes["X"] = chunk.end - chunk.offset
        self.chunk_bytes["T"] = offset - int(self._places[:, 0].min())
        return True


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
        if index.kind != "X" or index.end != size - 6:
            return False
        self.chunk_bytes |= {"T": offset - first.offset, "X": index.end - index.offset}
        return True
