"""What is done to one tile of a stream of several: it is looked at, fitted, or searched again."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol, TypeVar

from sgicodec.bitstream.parts.tile import read_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.device import Device
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.stages import encode, prepare, rd_model, texture, with_model
from sgicodec.encoder.tile.state import Tile, TileListener, tile_of
from sgicodec.encoder.tile.target import write_at_target
from sgicodec.encoder.tile.writing import (
    EncodedTile,
    network_weights,
    with_squared_error,
    write,
    write_nothing,
)
from sgicodec.executors.threads import stopping
from sgicodec.picture import Picture
from sgicodec.rate_control.rd_model import EMPTY_STREAM_BYTES, tile_side_bytes
from sgicodec.rate_control.tile_rd_model import LMBDA_GRID, RdTable
from sgicodec.rdoq.objective import with_values

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["FitTask", "LookaheadTask", "SearchTask", "Task"]


Made = TypeVar("Made", covariant=True)


class Task(Protocol[Made]):
    """What is done to a tile: pickled, and called where the pixels are."""

    def __call__(self, number: int, window: Picture, start: bytes, device: Device) -> Made:
        """Made of tile `number`, whose pixels are `window`. start: the payload of its chunk so far, empty for none."""


@dataclass(frozen=True)
class LookaheadTask:
    """Predicts bytes and error of a tile, without a fit."""

    plan: Plan

    def __call__(self, number: int, window: Picture, start: bytes, device: Device) -> RdTable:
        """A tile without valid pixels has neither bytes nor error."""
        tile = tile_of(window, self.plan, device, number)
        if tile.holds_nothing:
            return RdTable((0.0,) * len(LMBDA_GRID), (0.0,) * len(LMBDA_GRID))
        _, _, width, height = self.plan.header.grid.core(number)
        samples = width * height * tile.spec.channels
        model, side = rd_model(prepare(tile, tile.fit.lmbda)), tile_side_bytes(network_weights(tile.spec))
        predictions = [model.predict(lmbda) for lmbda in LMBDA_GRID]
        sizes = tuple(max(size - EMPTY_STREAM_BYTES, 0.0) + side for size, _ in predictions)
        return RdTable(sizes, tuple(samples * error for _, error in predictions))


@dataclass(frozen=True)
class FitTask:
    """Fits a tile at the plan's λ, or the only one towards the plan's target. listener: who is told, in this process;
    without one, the work ends where nobody waits for it any more. measures: with its squared error.
    """

    plan: Plan
    listener: TileListener | None = None
    measures: bool = False

    def __call__(self, number: int, window: Picture, start: bytes, device: Device) -> EncodedTile:
        """Fits the pixels that the tile covers, apron included."""
        began, listener = time.monotonic(), self.listener or _Waiting()
        listener.stage("prepare")
        tile = tile_of(window, self.plan, device, number, listener=listener)
        encoded, missed = _fitted(tile)
        if self.measures:
            encoded = with_squared_error(encoded, tile)
        watch = tile.watch
        return replace(
            encoded,
            seconds=time.monotonic() - began,
            steps=watch.steps,
            ended_early=watch.is_short or watch.ending(),
            fitted_by=watch.fitted_by,
            missed=missed,
        )


def _fitted(tile: Tile) -> tuple[EncodedTile, str | None]:
    """A tile after all stages, and how it misses what was asked for, if it does."""
    if tile.holds_nothing:
        return write_nothing(tile), None
    target = tile.settings.rate_target(tile.picture.width * tile.picture.height)
    return (write(encode(tile)), None) if target is None else write_at_target(tile, target)


class _Waiting(TileListener):
    """In a worker, whose work ends where nobody waits for it any more."""

    def step(self, progress: Progress) -> bool:
        """As in `TileListener`."""
        return not stopping()

    def ending(self) -> bool:
        """As in `TileListener`."""
        return stopping()


@dataclass(frozen=True)
class SearchTask:
    """Searches the texture of a finished tile again, for the plan's λ."""

    plan: Plan

    def __call__(self, number: int, window: Picture, start: bytes, device: Device) -> EncodedTile:
        """Lays texture over the seeds of the payload `start`."""
        began, tile = time.monotonic(), tile_of(window, self.plan, device, number)
        payload = decode_tile_chunk(self.plan.header, start).model
        if payload is None:
            return replace(write_nothing(tile), seconds=time.monotonic() - began)
        model, _ = read_tile(tile.header, payload, device)
        model = with_values(tile.spec, model, model.decoded_values)
        state = with_model(prepare(tile, tile.fit.lmbda), tile.header, model)
        return replace(write(texture(state)), seconds=time.monotonic() - began)
