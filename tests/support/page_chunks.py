"""The outer layer of a file, read as docs/format.md says: what the native reader is compared with."""

from __future__ import annotations

import io
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import BinaryIO

from page_varint import read_varint

from sgicodec.bitstream.container import MAX_PAYLOAD, SIGNATURE
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError, UsageError

__all__ = ["CHUNKS", "Chunk", "ChunkReader"]

HEADER, END = "H", "E"

CHUNKS = "TXogicxs"
"""Chunks besides these that this version knows: tile, index, overview, place on earth, ICC profile, EXIF as `c`amera
data, XMP, and what wrote the file.
"""

_BLOCK = 1 << 20
_CRC_BYTES = 4

_FOREIGN = (
    (b"\xff\xd8\xff", "a JPEG file"),
    (b"\x89PNG\r\n\x1a\n", "a PNG file"),
    (b"\x01\xda", "a Silicon Graphics image, which shares the extension .sgi"),
)

_DAMAGED = (
    SIGNATURE.replace(b"\r\n", b"\n"),
    SIGNATURE.replace(b"\r\n", b"\r\r\n")[:8],
    SIGNATURE.replace(b"\r\n", b"\r"),
    bytes(byte & 0x7F for byte in SIGNATURE),
    SIGNATURE.decode("latin-1").encode()[:8],
    b"\xef\xbf\xbdSGI",
)
"""What a text-mode transfer, a terminal of seven bits or a re-encoding as UTF-8 makes of the signature."""


@dataclass(frozen=True)
class Chunk:
    """One chunk of a file that is being read."""

    kind: str
    """Its letter."""
    offset: int
    """Where it starts in the file."""
    length: int
    """Bytes of payload."""
    head: bytes = field(repr=False)
    """Its first bytes, those before the payload."""
    reader: ChunkReader = field(repr=False)

    @property
    def end(self) -> int:
        """Where the next chunk starts in the file."""
        return self.offset + len(self.head) + self.length + _CRC_BYTES

    def __str__(self) -> str:
        return f"chunk {self.kind} at byte {self.offset}"

    def payload(self) -> bytes:
        """Reads the payload and checks its CRC; raises CorruptStreamError. A source that can seek allows this
        at any time, another one only before the next chunk is asked for.
        """
        return self.reader.read_payload(self)

    def check(self) -> None:
        """Checks the CRC as `payload` does, and keeps nothing."""
        self.reader.pass_over(self)


class ChunkReader:
    """Iterates over the known chunks of a file, from the header to the end mark, which is not among them.

    `source` is the file's bytes or a binary stream that stands at its start; one that can seek is never read
    further than asked for, so that chunks cost nothing until their payload is wanted. `known` are the letters
    that the caller understands. Raises CorruptStreamError, UnsupportedStreamError for an unknown required
    chunk and LimitError for a payload above `max_payload` bytes.
    """

    def __init__(self, source: bytes | BinaryIO, known: str, max_payload: int = MAX_PAYLOAD) -> None:
        self._file: BinaryIO = io.BytesIO(source) if isinstance(source, bytes) else source
        self._known = known + HEADER + END
        self._max_payload = max_payload
        self._seekable = self._file.seekable()
        self._position = 0
        self.end = 0
        """Bytes of the whole file; known once the end mark was reached."""
        self._start = self._file.tell() if self._seekable else 0
        self._size = self._file.seek(0, io.SEEK_END) - self._start if self._seekable else None
        if self._seekable:
            self._file.seek(self._start)
        self._check_signature()

    def __iter__(self) -> Iterator[Chunk]:
        """The chunks in file order; may be started over if the source can seek."""
        offset = len(SIGNATURE)
        while True:
            chunk = self._read_head(offset)
            if (chunk.kind == HEADER) != (offset == len(SIGNATURE)):
                raise CorruptStreamError(f"{chunk}: a file starts with its one header; this one is damaged")
            offset = chunk.end
            if chunk.kind == END:
                self.end = chunk.end
                break
            if chunk.kind in self._known:
                yield chunk
                continue
            chunk.check()  # a flipped bit must not turn a known chunk into an unknown one
            if chunk.kind.isupper():
                raise UnsupportedStreamError(f"{chunk} is required but unknown; decode the file with a newer version")
        if chunk.length or chunk.payload() or self._file.read(1):
            raise CorruptStreamError(f"{chunk}: there is data behind the end mark; the file is damaged")

    @property
    def size(self) -> int | None:
        """Bytes of a source that can seek."""
        return self._size

    def chunk_at(self, offset: int) -> Chunk:
        """The chunk that begins at `offset` of a source that can seek. Raises CorruptStreamError."""
        return self._read_head(offset)

    def peek(self, offset: int, count: int) -> bytes:
        """Up to `count` bytes from `offset` on of a source that can seek; they are not checked."""
        self._file.seek(self._start + offset)
        return self._file.read(count)

    def read_payload(self, chunk: Chunk) -> bytes:
        """See `Chunk.payload`."""
        if chunk.length > self._max_payload:
            raise LimitError(f"{chunk} has {chunk.length} bytes; at most {self._max_payload} are allowed here")
        return b"".join(self._body(chunk))

    def pass_over(self, chunk: Chunk) -> None:
        """See `Chunk.check`."""
        for _ in self._body(chunk):
            pass

    def _body(self, chunk: Chunk) -> Iterator[bytes]:
        """The payload in blocks, then the check of its CRC: a lying length cannot make memory be taken."""
        self._go_to(chunk.offset + len(chunk.head), chunk)
        crc = zlib.crc32(chunk.head)
        left = chunk.length
        while left:
            block = self._read(min(left, _BLOCK), chunk)
            crc = zlib.crc32(block, crc)
            left -= len(block)
            yield block
        if int.from_bytes(self._read(_CRC_BYTES, chunk), "little") != crc:
            raise CorruptStreamError(f"{chunk}: wrong CRC; the file is damaged")

    def _read_head(self, offset: int) -> Chunk:
        cut = f"the file ends at byte {offset} without its end mark; it was cut short"
        self._go_to(offset, cut)
        head = bytearray(self._read(1, cut))
        kind = chr(head[0])
        if not (kind.isascii() and kind.isalpha()):
            raise CorruptStreamError(f"byte {offset} starts no chunk; the file is damaged")

        def read_byte() -> int:
            head.extend(self._read(1, cut))
            return head[-1]

        length = read_varint(read_byte)
        chunk = Chunk(kind, offset, length, bytes(head), self)
        if self._size is not None and chunk.end > self._size:
            raise CorruptStreamError(f"the file ends inside {chunk}; it was cut short")
        return chunk

    def _go_to(self, offset: int, where: object) -> None:
        if self._seekable:
            self._file.seek(self._start + offset)
        elif offset < self._position:
            raise UsageError(f"{where} has gone by, and this source cannot seek; read payloads in file order")
        while self._position < offset and not self._seekable:
            self._read(min(offset - self._position, _BLOCK), where)

    def _read(self, count: int, where: object) -> bytes:
        """Exactly `count` bytes, at most a block."""
        data = self._file.read(count)
        while 0 < len(data) < count and (more := self._file.read(count - len(data))):  # a pipe gives what it has
            data += more
        self._position += len(data)
        if len(data) < count:
            raise CorruptStreamError(
                where if isinstance(where, str) else f"the file ends inside {where}; it was cut short"
            )
        return data

    def _check_signature(self) -> None:
        head = b""
        while len(head) < len(SIGNATURE) and (more := self._file.read(len(SIGNATURE) - len(head))):
            head += more
        self._position = len(head)
        if head == SIGNATURE:
            return
        if not head:
            raise CorruptStreamError("the file is empty")
        if SIGNATURE.startswith(head):
            raise CorruptStreamError(f"the file ends after {len(head)} bytes; it was cut short")
        for magic, name in _FOREIGN:
            if head.startswith(magic):
                raise CorruptStreamError(f"this is {name}, no stream of this codec; encode it first")
        if any(head.startswith(damaged) for damaged in _DAMAGED):
            raise CorruptStreamError(
                "the signature was altered by a transfer in text mode; copy the file in binary mode"
            )
        raise CorruptStreamError(f"no stream of this codec: it starts with {head.hex(' ')}")
