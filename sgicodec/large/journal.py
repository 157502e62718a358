"""What a long encode has done so far, safe on disk: finished tiles, in the order in which they came."""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import BinaryIO

from sgicodec.bitstream.header import encode_header
from sgicodec.encoder import EncodedTile
from sgicodec.errors import OutputExistsError, UsageError
from sgicodec.plan import Plan

__all__ = ["Journal", "fingerprint", "opened_journal"]

_SIGNATURE = b"\x89SGI-part 1\n"
_BLOCK = 1 << 20


def fingerprint(plan: Plan, source: Path | None) -> bytes:
    """32 bytes that change with the settings, this program's version, or any byte of the source."""
    digest = hashlib.sha256(encode_header(plan.header) + plan.software)
    blobs = asdict(plan.metadata) if plan.metadata else {}
    digest.update(repr((replace(plan.settings, threads=0), blobs)).encode())
    if source is not None:
        with source.open("rb") as file:
            while block := file.read(_BLOCK):
                digest.update(block)
    return digest.digest()


class Journal:
    """An open journal: signature, fingerprint, then records of a length, a CRC-32, a line of JSON and a payload.

    A record that a kill cut short is dropped when the journal is opened again, with all behind it.
    """

    def __init__(self, file: BinaryIO, mark: bytes) -> None:
        self._file = file
        self._places: dict[int, tuple[int, int]] = {}
        self.tiles: dict[int, EncodedTile] = {}
        """Finished tiles by number, without their payloads."""
        head = _SIGNATURE + mark
        found = file.read(len(head))
        if found.startswith(_SIGNATURE) and len(found) == len(head) and found != head:
            raise UsageError("the source, the settings or the program changed since; -f starts over")
        if found == head:
            self._load()
        else:
            file.seek(0)
            file.truncate()
            self._write(head)

    def add(self, number: int, tile: EncodedTile) -> None:
        """Writes a finished tile and waits until it is on the disk."""
        facts = {name: value for name, value in asdict(tile).items() if name != "payload"} | {"tile": number}
        line = json.dumps(facts).encode() + b"\n"
        body = line + tile.payload
        sizes = len(line).to_bytes(4, "little") + len(body).to_bytes(8, "little")
        start = self._file.tell()
        self._write(sizes + zlib.crc32(body).to_bytes(4, "little") + body)
        self._note(number, tile, start + 16 + len(line), len(tile.payload))

    def payloads(self) -> Iterator[bytes]:
        """The payloads of all tiles by number."""
        for number in sorted(self._places):
            offset, length = self._places[number]
            self._file.seek(offset)
            yield self._file.read(length)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._file.flush()
        os.fsync(self._file.fileno())

    def _note(self, number: int, tile: EncodedTile, offset: int, length: int) -> None:
        self._places[number] = offset, length
        self.tiles[number] = replace(tile, payload=b"")

    def _load(self) -> None:
        while True:
            start = self._file.tell()
            sizes = self._file.read(16)
            line_bytes, body_bytes = int.from_bytes(sizes[:4], "little"), int.from_bytes(sizes[4:12], "little")
            left = os.fstat(self._file.fileno()).st_size - start - 16
            body = self._file.read(body_bytes) if len(sizes) == 16 and body_bytes <= left else b""
            if not body or zlib.crc32(body).to_bytes(4, "little") != sizes[12:]:
                break
            facts = json.loads(body[:line_bytes])
            number, payload = facts.pop("tile"), body[line_bytes:]
            self._note(number, EncodedTile(payload, **facts), start + 16 + line_bytes, len(payload))
        self._file.seek(start)
        self._file.truncate()


@contextmanager
def opened_journal(path: Path, mark: bytes, resume: bool, force: bool) -> Iterator[Journal]:
    """The journal at `path`: gone after a success, there for --resume after an exception.

    Raises OutputExistsError for one that nobody asked to go on with, UsageError for that of another encode.
    """
    there = path.exists()
    if there and not (resume or force):
        raise OutputExistsError(f"{path} holds an encode that was interrupted; --resume goes on, -f starts over")
    with path.open("r+b" if there and resume else "w+b") as file:
        try:
            journal = Journal(file, mark)
        except UsageError as error:
            raise UsageError(f"{path}: {error}") from None
        yield journal
    path.unlink()
