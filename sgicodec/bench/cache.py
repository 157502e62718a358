"""What peers coded in earlier runs: the same library with the same settings codes a picture the same way every time."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable
from pathlib import Path

from sgicodec.bench.rows import Key, Results, Row

__all__ = ["PeerCache"]


class PeerCache:
    """Rows and streams of peers in a folder, by codec, version, settings and picture; the picture's name is free."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._folder = folder
        self._results = Results(folder / "results.tsv")
        self._rows = {_nameless(row.key): row for row in self._results.rows.values()}

    def row(self, key: Key) -> Row | None:
        """The row of a point under the picture's present name, if an earlier run measured it."""
        row = self._rows.get(_nameless(key))
        return None if row is None else dataclasses.replace(row, picture=key[3])

    def keep(self, row: Row) -> None:
        """Add a row."""
        self._results.append(row)
        self._rows[_nameless(row.key)] = row

    def stream(self, key: Key, encode: Callable[[], bytes]) -> bytes:
        """The stream of a point: of an earlier run, or what `encode` makes now."""
        name = hashlib.sha256("\t".join(_nameless(key)).encode()).hexdigest()[:24]
        path = self._folder / "streams" / name
        if not path.exists():
            path.parent.mkdir(exist_ok=True)
            part = path.with_suffix(".part")
            part.write_bytes(encode())
            part.replace(path)
        return path.read_bytes()


def _nameless(key: Key) -> tuple[str, ...]:
    return (*key[:3], key[4])
