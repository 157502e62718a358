"""What is done to one tile of a stream."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

from sgicodec.device import Device
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.stages import encode
from sgicodec.encoder.tile.state import TileListener, tile_of
from sgicodec.encoder.tile.writing import EncodedTile, write, write_nothing
from sgicodec.picture import Picture

Made = TypeVar("Made", covariant=True)


class Task(Protocol[Made]):
    """What is done to a tile: pickled, and called where the pixels are."""

    def __call__(self, number: int, window: Picture, device: Device) -> Made:
        """Made of tile `number`, whose pixels are `window`."""


@dataclass(frozen=True)
class FitTask:
    """Takes a tile through all stages at the plan's λ. listener: who is told, in this process; None for nobody."""

    plan: Plan
    listener: TileListener | None = None

    def __call__(self, number: int, window: Picture, device: Device) -> EncodedTile:
        """Encodes the pixels that the tile covers, apron included."""
        listener = self.listener or TileListener()
        listener.stage("prepare")
        tile = tile_of(window, self.plan, device, number, listener=listener)
        encoded = write_nothing(tile) if tile.holds_nothing else write(encode(tile))
        watch = tile.watch
        return replace(
            encoded,
            steps=watch.steps,
            ended_early=watch.is_short or watch.ending(),
            fitted_by=watch.fitted_by,
        )
