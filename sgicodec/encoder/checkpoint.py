"""What a long encode has done so far, safe on disk: finished tiles, in the order in which they came, and what was
decided on them.
"""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, BinaryIO

from sgicodec.bitstream.header import encode_header
from sgicodec.encoder.interfaces import Version
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile_work import EncodedTile
from sgicodec.errors import OutputExistsError, UsageError

__all__ = ["Journal", "fingerprint", "opened_journal"]

_SIGNATURE = b"\x89SGI-part 2\n"
_BLOCK = 1 << 20


def fingerprint(plan: Plan, source: Path | None) -> bytes:
    """32 bytes that change with the settings, this program's version, or any byte of the source. Of a time limit only
    whether there is one counts: the next run may have more time, or less.
    """
    limited = plan.settings.time_limit is not None
    software = plan.software.rpartition(b" ")[0] if limited else plan.software
    digest = hashlib.sha256(encode_header(plan.header) + software)
    blobs = asdict(plan.metadata) if plan.metadata else {}
    settings = replace(plan.settings, time_limit=1.0 if limited else None)
    digest.update(repr((settings, blobs)).encode())
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
        self._places: dict[Version, tuple[int, int]] = {}
        self._numbers: dict[str, float] = {}
        self._blobs: dict[str, bytes] = {}
        self.tiles: dict[Version, EncodedTile] = {}
        """Finished tiles, without their payloads."""
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

    def add(self, version: Version, tile: EncodedTile) -> None:
        """Writes a finished tile and waits until it is on the disk."""
        facts = {name: value for name, value in asdict(tile).items() if name != "payload"}
        offset = self._record(facts | version._asdict(), tile.payload)
        self._note(version, tile, offset, len(tile.payload))

    def kept(self, name: str, made: Callable[[], bytes]) -> bytes:
        """The bytes that were kept under this name, else what is made now, which is kept."""
        if name not in self._blobs:
            blob = made()
            self._record({"blob": name}, blob)
            self._blobs[name] = blob
        return self._blobs[name]

    def remembered(self, name: str, found: Callable[[], float]) -> float:
        """The number that was kept under this name, else what is found now, which is kept."""
        if name not in self._numbers:
            value = found()
            self._record({"name": name, "value": value}, b"")
            self._numbers[name] = value
        return self._numbers[name]

    def payload(self, version: Version) -> bytes:
        """That of a finished tile."""
        offset, length = self._places[version]
        end = self._file.tell()
        self._file.seek(offset)
        payload = self._file.read(length)
        self._file.seek(end)
        return payload

    def _record(self, facts: dict[str, Any], payload: bytes) -> int:
        """Writes a record; returns where its payload is."""
        line = json.dumps(facts).encode() + b"\n"
        body = line + payload
        sizes = len(line).to_bytes(4, "little") + len(body).to_bytes(8, "little")
        start = self._file.tell()
        self._write(sizes + zlib.crc32(body).to_bytes(4, "little") + body)
        return start + 16 + len(line)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._file.flush()
        os.fsync(self._file.fileno())

    def _note(self, version: Version, tile: EncodedTile, offset: int, length: int) -> None:
        self._places[version] = offset, length
        self.tiles[version] = replace(tile, payload=b"")

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
            if "name" in facts:
                self._numbers[facts["name"]] = facts["value"]
                continue
            if "blob" in facts:
                self._blobs[facts["blob"]] = body[line_bytes:]
                continue
            version, payload = Version(facts.pop("tile"), facts.pop("round")), body[line_bytes:]
            self._note(version, EncodedTile(payload, **facts), start + 16 + line_bytes, len(payload))
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
