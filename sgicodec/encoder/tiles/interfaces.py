"""What passes over tiles are made of: tasks and stores, codings of tiles, and what comes out."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeVar

from sgicodec.device import Device
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tiles.tasks import EncodedTile
from sgicodec.picture import Picture

__all__ = ["Finished", "Store", "Task", "Version"]

Made = TypeVar("Made", covariant=True)
Value = TypeVar("Value", bytes, float)


class Version(NamedTuple):
    """A coding of a tile: its number, and the pass that made it."""

    tile: int
    round: int = 0


class Task(Protocol[Made]):
    """What is done to a tile: pickled, and called where the pixels are."""

    def __call__(self, number: int, window: Picture, start: bytes, device: Device) -> Made:
        """Made of tile `number`, whose pixels are `window`. start: the payload of its chunk so far, empty for none."""


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


@dataclass(frozen=True)
class Finished:
    """Which coding of each tile the stream takes, the plan of its header, the λ of the last fits, and what was asked
    for and not reached. overview: a stream of its own.
    """

    plan: Plan
    chosen: list[Version]
    lmbda: float
    missed: str | None = None
    overview: bytes | None = None
