"""Codings of tiles, and where they are kept: in memory; `checkpoint` keeps them in a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from sgicodec.encoder.tile.writing import EncodedTile


class Version(NamedTuple):
    """A coding of a tile: its number, and the pass that made it."""

    tile: int
    pass_number: int = 0


class Store:
    """Codings in memory: gone with the object. tiles: all of them, with or without their payloads."""

    def __init__(self) -> None:
        self.tiles: dict[Version, EncodedTile] = {}
        self._values: dict[str, bytes] = {}

    @contextmanager
    def opened(self, fingerprint: Callable[[], bytes]) -> Iterator[Store]:
        """The time of one encode, which `fingerprint` tells from others."""
        yield self

    def add(self, version: Version, tile: EncodedTile) -> None:
        """Keeps a finished tile."""
        self.tiles[version] = tile

    def payload(self, version: Version) -> bytes:
        """That of a kept tile."""
        return self.tiles[version].payload

    def cached(self, name: str, make: Callable[[], bytes]) -> bytes:
        """The value under a name, else what is made now, which is kept."""
        if name not in self._values:
            self._values[name] = make()
        return self._values[name]
