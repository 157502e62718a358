"""The checkpoint of a long encode: an SQLite file of finished tiles and overviews."""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from sgicodec.bitstream.header import encode_header
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.encoder.tiles.store import Store, Version
from sgicodec.errors import OutputExistsError, PictureError, StreamError, UsageError
from sgicodec.files.lock import locked

_TABLES = """
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA synchronous = EXTRA;
PRAGMA application_id = 0x73676963;
BEGIN EXCLUSIVE;
CREATE TABLE IF NOT EXISTS encode (fingerprint BLOB);
CREATE TABLE IF NOT EXISTS tiles (tile INTEGER, pass INTEGER, facts TEXT, payload BLOB, crc INTEGER,
    PRIMARY KEY (tile, pass));
CREATE TABLE IF NOT EXISTS cached (name TEXT PRIMARY KEY, value, crc INTEGER);
COMMIT;
"""
"""A statement is on the disk when it returns, and a second encode cannot open the file."""
_MAGIC, _MARK, _MARK_AT = b"SQLite format 3\0", b"sgic", 68
"""How SQLite's files begin, and the application that ours name."""


def fingerprint(plan: Plan, picture: bytes) -> bytes:
    """32 bytes that change with the settings, this program's version, or the digest of the picture."""
    blobs = asdict(plan.metadata) if plan.metadata else {}
    settings = plan.software + repr((plan.settings, blobs)).encode()
    return hashlib.sha256(encode_header(plan.header) + settings + picture).digest()


class Checkpoint(Store):
    """A `Store` in the file at `path`: gone after a success, there to resume from after an exception or a kill.

    Without a finished tile nothing is left. resume: whether to go on with a file that is there; force: whether to start
    over instead. tiles have no payloads.
    """

    def __init__(self, path: str | Path, resume: bool = False, force: bool = False) -> None:
        if not isinstance(path, str | Path):
            raise UsageError(f"a {type(path).__name__} is no path")
        super().__init__()
        self.path, self._resume, self._force = Path(path), resume, force

    @contextmanager
    def opened(self, fingerprint: Callable[[], bytes]) -> Iterator[Checkpoint]:
        """As in `Store`. Raises OutputExistsError for a file that is not to be resumed, OutputLockedError for that of a
        running encode, UsageError for that of another encode or a damaged one, PictureError where it cannot be written.
        """
        with locked(self.path):
            yield from self._opened(fingerprint)

    def _opened(self, fingerprint: Callable[[], bytes]) -> Iterator[Checkpoint]:
        import sqlite3

        if not _is_replaceable(self.path):
            raise UsageError(f"{self.path} is no checkpoint of sgi; move it, or name another OUT")
        if self.path.exists() and not self._resume:
            if not self._force:
                text = "holds an encode that was interrupted; --resume goes on, -f starts over"
                raise OutputExistsError(f"{self.path} {text}")
            self._remove()
        is_own, mark = not self.path.exists(), fingerprint()
        try:
            with closing(sqlite3.connect(self.path, timeout=0, isolation_level=None)) as self._database:
                self._load(mark)
                is_own = True
                yield self
        except sqlite3.DatabaseError as error:
            code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR)
            if isinstance(error, sqlite3.OperationalError) and code != sqlite3.SQLITE_ERROR:
                text = "the disk may be full, or the size of files limited (ulimit -f)"
                raise PictureError(f"{self.path}: {error}; {text}") from error
            raise UsageError(f"{self.path}: this is no sound checkpoint ({error}); -f starts over") from error
        finally:
            if is_own and not self.tiles:
                self._remove()
        self._remove()

    def add(self, version: Version, tile: EncodedTile) -> None:
        """Writes a finished tile and waits until it is on the disk."""
        facts = json.dumps({name: value for name, value in asdict(tile).items() if name != "payload"})
        row = (*version, facts, tile.payload, _crc(*version, facts, tile.payload))
        self._database.execute("INSERT OR REPLACE INTO tiles VALUES (?, ?, ?, ?, ?)", row)
        self.tiles[version] = replace(tile, payload=b"")

    def payload(self, version: Version) -> bytes:
        """As in `Store`."""
        query = "SELECT facts, payload, crc FROM tiles WHERE tile = ? AND pass = ?"
        facts, payload, crc = self._database.execute(query, version).fetchone() or ("", b"", None)
        if _crc(*version, facts, payload) != crc:
            raise StreamError(f"{self.path}: tile {version.tile} changed on the disk; run again with --resume")
        return bytes(payload)

    def cached(self, name: str, make: Callable[[], bytes]) -> bytes:
        """As in `Store`."""
        if name not in self._values:
            value = make()
            self._database.execute("INSERT OR REPLACE INTO cached VALUES (?, ?, ?)", (name, value, _crc(name, value)))
            self._values[name] = value
        return self._values[name]

    def _load(self, mark: bytes) -> None:
        import sqlite3

        self._database.text_factory = lambda text: text.decode("utf-8", "replace")  # what is damaged has another CRC
        try:
            self._database.executescript(_TABLES)
        except UnicodeDecodeError as error:  # of a message that quotes what is damaged
            raise sqlite3.DatabaseError("malformed") from error
        row = self._database.execute("SELECT fingerprint FROM encode").fetchone()
        if row is None:
            self._database.execute("INSERT INTO encode VALUES (?)", (mark,))
        elif row[0] != mark:
            raise UsageError(f"{self.path}: the source, the settings or the program changed since; -f starts over")
        values = self._database.execute("SELECT name, value, crc FROM cached")
        self._values = {name: value for name, value, crc in values if _crc(name, value) == crc}
        self.tiles = dict(self._rows())

    def _rows(self) -> Iterator[tuple[Version, EncodedTile]]:
        """The finished tiles, but for those that the disk changed."""
        query = "SELECT tile, pass, facts, payload, crc FROM tiles ORDER BY rowid"
        for tile, pass_number, facts, payload, crc in self._database.execute(query):
            if _crc(tile, pass_number, facts, payload) == crc:
                known: dict[str, Any] = json.loads(facts)
                yield Version(tile, pass_number), EncodedTile(b"", **known)

    def _remove(self) -> None:
        """With what SQLite left beside it when it was killed."""
        self.path.unlink(missing_ok=True)
        self.path.with_name(f"{self.path.name}-journal").unlink(missing_ok=True)


def _is_replaceable(path: Path) -> bool:
    """Whether there is nothing, an empty file or a checkpoint, sound or not."""
    try:
        with path.open("rb") as file:
            head = file.read(_MARK_AT + len(_MARK))
    except FileNotFoundError:
        return True
    except OSError:  # a folder, a file that may not be read
        return False
    return not head or (head.startswith(_MAGIC) and head.endswith(_MARK))


def _crc(*values: object) -> int:
    """That of a row, whatever a flipped bit made of the types of its columns."""
    return zlib.crc32(b"".join(value if isinstance(value, bytes) else repr(value).encode() for value in values))
