"""The store of an encode without a checkpoint: codings of tiles in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from sgicodec.encoder.tiles.interfaces import Version
from sgicodec.encoder.tiles.tasks import EncodedTile

__all__ = ["MemoryStore"]

Value = TypeVar("Value", bytes, float)


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
