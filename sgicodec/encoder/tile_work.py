"""What is done to one tile of a stream of several: it is looked at, fitted, or searched again."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

from sgicodec.bitstream.parts.tile import read_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.candidate import Candidate, written
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile_encoder import Encoding
from sgicodec.executors.threads import stopping
from sgicodec.metrics.distortion import squared_error
from sgicodec.picture import Picture
from sgicodec.rate_control.side_information import EMPTY_STREAM_BYTES, tile_side_bytes
from sgicodec.rate_control.tile_rd_model import LMBDA_GRID, RdTable
from sgicodec.rdoq import Rdoq
from sgicodec.rdoq.adaptation import with_coarser_steps
from sgicodec.rdoq.objective import with_values

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["EncodedTile", "FitTask", "LookaheadTask", "SearchTask", "Start", "encode_tile"]


@dataclass(frozen=True)
class EncodedTile:
    """A finished tile. payload: of its chunk; part_bytes, seeds as in `Encoded`; squared_error: of what is decoded, in
    the tile's core, over `samples` of them in 0..1; distortion: what λ trades for bytes, of the same; seconds: that it
    took, `decoding` of them to decode it; length: of the payload; lmbda: its λ; steps: of its fit; fitted_by: the name
    of what made that, empty without a fit.
    """

    payload: bytes
    part_bytes: dict[str, float]
    seeds: int
    squared_error: float
    distortion: float
    samples: int
    seconds: float
    length: int
    lmbda: float
    decoding: float = 0.0
    steps: int = 0
    fitted_by: str = ""


class Start(NamedTuple):
    """Where a search begins: the payload of a tile's chunk and the λ that it was made for. seconds: that the tile
    may take, instead of a number of steps.
    """

    payload: bytes = b""
    lmbda: float = 0.0
    seconds: float | None = None

    def later(self, seconds: float) -> Start:
        """The same after `seconds` have passed."""
        return self if self.seconds is None else self._replace(seconds=max(1e-3, self.seconds - seconds))


@dataclass(frozen=True)
class LookaheadTask:
    """Predicts bytes and error of a tile, without a fit."""

    plan: Plan

    def __call__(self, number: int, window: Picture, start: Start, device: Device) -> RdTable:
        """A tile without valid pixels has neither bytes nor error."""
        tile = _encoding(window, self.plan, number, device)
        if tile.holds_nothing:
            return RdTable((0.0,) * len(LMBDA_GRID), (0.0,) * len(LMBDA_GRID))
        _, _, width, height = self.plan.header.grid.core(number)
        samples = width * height * self.plan.header.spec.channels
        rd_model, side = tile.rd_model(), tile_side_bytes(tile.stream.network_weights)
        found = [rd_model.predict(lmbda) for lmbda in LMBDA_GRID]
        sizes = tuple(max(size - EMPTY_STREAM_BYTES, 0.0) + side for size, _ in found)
        return RdTable(sizes, tuple(samples * error for _, error in found))


@dataclass(frozen=True)
class FitTask:
    """Fits a tile at the plan's λ."""

    plan: Plan

    def __call__(self, number: int, window: Picture, start: Start, device: Device) -> EncodedTile:
        """Fits the pixels that the tile covers, apron included."""
        return encode_tile(window, self.plan, number, device, start.seconds)


@dataclass(frozen=True)
class SearchTask:
    """Searches the texture of a finished tile again, or without texture its symbols, for the plan's λ."""

    plan: Plan

    def __call__(self, number: int, window: Picture, start: Start, device: Device) -> EncodedTile:
        """A model that cannot be searched has its steps moved as λ asks for."""
        started, tile = time.monotonic(), _encoding(window, self.plan, number, device)
        payload = decode_tile_chunk(self.plan.header, start.payload).model
        if payload is None:
            return _finished(tile, self.plan, number, None, started)
        header, lmbda = tile.plan.header, tile.lmbda
        model, _ = read_tile(header, payload, device)
        model = with_values(header.spec, model, model.decoded_values)
        if header.spec.texture:
            return _finished(tile, self.plan, number, tile.textured(Candidate(header, model, lmbda)), started)
        if not tile.searches:
            octaves = 0.5 * math.log2(lmbda / start.lmbda)
            model = replace(model, networks=with_coarser_steps(model.networks, octaves))
            return _finished(tile, self.plan, number, Candidate(header, model, lmbda), started)
        settings = tile.effort.rdoq
        settings = replace(settings, coarser=0.0, passes=max(_LEAST_PASSES, settings.passes // _PASSES_SHARE))
        rdoq = Rdoq(header, model, tile.unit, start.lmbda, settings, device, tile.reference)
        for _ in range(settings.passes):
            model = rdoq.descend(lmbda).model
        return _finished(tile, self.plan, number, Candidate(header, model, lmbda), started)


_LEAST_PASSES, _PASSES_SHARE = 2, 3
"""Passes of a search after a search: at least, and of those after a fit."""


def encode_tile(
    window: Picture,
    plan: Plan,
    number: int,
    device: Device = ALL_CORES,
    seconds: float | None = None,
) -> EncodedTile:
    """Fits tile `number` of a stream of several to its pixels, apron included; in about `seconds`, if given."""
    started, tile = time.monotonic(), _encoding(window, plan, number, device, seconds)
    steps = 0

    def watch(progress: Progress) -> bool:
        nonlocal steps
        steps = progress.step
        return not stopping()

    tile.ending = stopping
    candidate = None
    if not tile.holds_nothing:
        candidate = tile.textured(tile.settled(tile.searched(tile.candidate(tile.fitted(watch)))))
    return replace(_finished(tile, plan, number, candidate, started), steps=steps, fitted_by=tile.fitted_by)


def _encoding(window: Picture, plan: Plan, number: int, device: Device, seconds: float | None = None) -> Encoding:
    started = time.monotonic()
    header, settings = plan.header, replace(plan.settings, time_limit=seconds)
    if settings.seeds is not None:
        share = window.width * window.height / (header.width * header.height)
        settings = replace(settings, seeds=max(1, round(settings.seeds * share)))
    own = replace(plan, header=header.of_tile(number), settings=settings, metadata=None)
    tile = Encoding(window, own, started, device)
    tile.fit = replace(tile.fit, quality=header.quality)
    return tile


def _finished(tile: Encoding, plan: Plan, number: int, candidate: Candidate | None, started: float) -> EncodedTile:
    """The tile's payload, measured on its own: where it fades into its neighbours, they make the error smaller."""
    header, model, parts, seeds = plan.header, None, dict[str, float](), 0
    if candidate is not None:
        model, parts = written(candidate)
        seeds = len(candidate.model.layout)
    payload = tile.stream.chunk(header, number, model)
    if header.masked is not None or header.has_exact:
        parts["mask"] = len(payload) - len(model or b"")
    coded = time.monotonic()
    decoded = tile.stream.decoded(tile.stream.assembled(tile.plan.header, model)[0])
    decoding = time.monotonic() - coded
    core, weights = _core(plan, number), tile.reference.weights
    own, shown = (replace(picture, pixels=picture.pixels[core]) for picture in (tile.picture, decoded))
    error = squared_error(own, shown)
    distortion = error if weights is None else squared_error(own, shown, weights[core])
    size, seconds = len(payload), time.monotonic() - started
    return EncodedTile(payload, parts, seeds, error, distortion, own.pixels.size, seconds, size, tile.lmbda, decoding)


def _core(plan: Plan, number: int) -> tuple[slice, slice]:
    """Rows and columns of a tile's pixels that are in no other core."""
    grid = plan.header.grid
    (left, top, _, _), (x, y, width, height) = grid.rect(number), grid.core(number)
    return slice(y - top, y - top + height), slice(x - left, x - left + width)
