"""Stores of codings of tiles: what one is, and the one in memory; `checkpoint` has the one in a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import NamedTuple, Protocol, TypeVar

from sgicodec.encoder.tile.writing import EncodedTile

__all__ = ["MemoryStore", "Store", "Version"]


Value = TypeVar("Value", bytes, float)


class Version(NamedTuple):
    """A coding of a tile: its number, and the pass that made it."""

    tile: int
    round: int = 0


class Store(Protocol):
    """Where codings are kept. tiles: all of them, with or without their payloads."""

    tiles: dict[Version, EncodedTile]

    def opened(self, fingerprint: Callable[[], bytes]) -> AbstractContextManager[object]:
        """The time of one encode, which `fingerprint` tells from others."""

    def add(self, version: Version, tile: EncodedTile) -> None:
        """Keeps a finished tile."""

    def payload(self, version: Version) -> bytes:
        """That of a kept tile."""

    def cached(self, name: str, make: Callable[[], Value]) -> Value:
        """The value under a name, else what is made now, which is kept."""


class MemoryStore:
    """Codings in memory: gone with the object."""

    def __init__(self) -> None:
        self.tiles: dict[Version, EncodedTile] = {}
        self._values: dict[str, bytes | float] = {}

    @contextmanager
    def opened(self, fingerprint: Callable[[], bytes]) -> Iterator[MemoryStore]:
        """As in `Store`."""
        yield self

    def add(self, version: Version, tile: EncodedTile) -> None:
        """As in `Store`."""
        self.tiles[version] = tile

    def payload(self, version: Version) -> bytes:
        """As in `Store`."""
        return self.tiles[version].payload

    def cached(self, name: str, make: Callable[[], Value]) -> Value:
        """As in `Store`."""
        if name not in self._values:
            self._values[name] = make()
        return self._values[name]  # type: ignore[return-value]
