"""A tile as a stream has it: its chunk, and a stream of it alone, to measure it."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass, replace

import numpy as np

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import write_tile
from sgicodec.bitstream.parts.tile_chunk import ExactSamples, decode_tile_chunk, encode_tile_chunk
from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.tile.state import Tile, TileState
from sgicodec.metrics.distortion import squared_error
from sgicodec.metrics.psnr import psnr
from sgicodec.metrics.visual_score import visual_score
from sgicodec.model.context import input_count
from sgicodec.model.spec import ModelSpec
from sgicodec.picture import Metadata, Picture, comparable, to_rgb8
from sgicodec.rate_control.target import Measured, RateTarget

__all__ = [
    "EncodedTile",
    "measured",
    "network_weights",
    "stream_of",
    "with_squared_error",
    "write",
    "write_nothing",
]


@dataclass(frozen=True)
class EncodedTile:
    """A finished tile."""

    payload: bytes
    """Of its chunk."""
    part_bytes: dict[str, float]
    """What each part of it costs."""
    seeds: int
    squared_error: float
    """Of what is decoded, in the tile's core, samples in 0..1; not-a-number where nobody asks for it."""
    seconds: float
    """That it took, 0 before it is known."""
    length: int
    """Bytes of the payload, which may not be here."""
    lmbda: float
    """Its λ."""
    steps: int = 0
    """Of its fit."""
    fitted_by: str = ""
    """The name of what made the fit, empty without one."""
    header: Header | None = None
    """The stream's, where its only tile changes it."""
    ended_early: bool = False
    """Whether the caller ended its fit or search."""
    missed: str | None = None
    """How the only tile misses the target."""


def write(state: TileState) -> EncodedTile:
    """The tile as its stream has it."""
    tile, header, model = state.tile, state.header, state.model
    if tile.is_only:  # a header says no more than there is
        spec = header.spec
        texture = spec.texture and model.texture is not None
        restoration = spec.restoration and model.restoration is not None
        network = header.network if restoration else b""
        header = replace(header, spec=replace(spec, texture=texture, restoration=restoration), network=network)
    coded, writer = write_tile(header, model)
    parts = {name: bits / 8 for name, bits in writer.bits.items()}
    return _encoded(tile, header, coded, parts, len(model.layout), state.lmbda)


def write_nothing(tile: Tile) -> EncodedTile:
    """A tile that holds nothing."""
    return _encoded(tile, tile.header, None, {}, 0, tile.fit.lmbda)


def _encoded(
    tile: Tile, header: Header, coded: bytes | None, parts: dict[str, float], seeds: int, lmbda: float
) -> EncodedTile:
    """The tile with this model, None for nothing."""
    stream_header = header if tile.is_only else tile.plan.header
    payload = _chunk(tile, stream_header, tile.number, coded)
    if stream_header.masked is not None or stream_header.has_exact:
        parts["mask"] = len(payload) - len(coded or b"")
    stated = header if tile.is_only else None
    return EncodedTile(payload, parts, seeds, math.nan, 0.0, len(payload), lmbda, header=stated)


def with_squared_error(encoded: EncodedTile, tile: Tile) -> EncodedTile:
    """One of several tiles, measured on its own: where it fades into its neighbours, they make the error smaller."""
    coded = decode_tile_chunk(tile.plan.header, encoded.payload).model
    shown = _decoded(_stream(tile, tile.header, _chunk(tile, tile.header, 0, coded)), tile)
    core = _core(tile)
    ours, theirs = (replace(picture, pixels=picture.pixels[core]) for picture in (tile.picture, shown))
    return replace(encoded, squared_error=squared_error(ours, theirs))


def measured(encoded: EncodedTile, tile: Tile, target: RateTarget) -> Measured:
    """What the stream of the only tile is; of its PSNR and score, only what is asked for."""
    data = stream_of(encoded, tile)

    def decibels() -> float:
        counts = np.array(True) if tile.empty is None else ~tile.empty[..., None]
        pictures = (tile.picture, _decoded(data, tile))
        return psnr(*(np.where(counts, comparable(picture), 0) for picture in pictures))

    def score() -> float:
        return visual_score(to_rgb8(tile.picture), to_rgb8(_decoded(data, tile)), tile.device)

    return target.measure(len(data), decibels, score)


def stream_of(encoded: EncodedTile, tile: Tile) -> bytes:
    """The stream of the only tile."""
    return _stream(tile, encoded.header or tile.header, encoded.payload, tile.plan.metadata)


def _stream(tile: Tile, header: Header, payload: bytes, metadata: Metadata | None = None) -> bytes:
    buffer = io.BytesIO()
    write_stream(buffer, header, tile.plan.software, metadata, [payload])
    return buffer.getvalue()


def _decoded(data: bytes, tile: Tile) -> Picture:
    with open_stream(data, tile.device.processor) as stream:
        return stream.picture()


def _chunk(tile: Tile, header: Header, number: int, coded: bytes | None) -> bytes:
    """The payload of chunk T of a model, None for nothing."""
    empty = tile.empty if header.masked == "transparent" else tile.bare.nodata
    exact = None
    if tile.bare.exact is not None:
        places = np.flatnonzero(tile.bare.exact)
        exact = ExactSamples(places, tile.picture.pixels[..., : tile.picture.alpha].reshape(-1)[places])
    return encode_tile_chunk(header, number, empty, coded, exact)


def _core(tile: Tile) -> tuple[slice, slice]:
    """Rows and columns of a tile's pixels that are in no other core."""
    grid, number = tile.plan.header.grid, tile.number
    (left, top, _, _), (x, y, width, height) = grid.rect(number), grid.core(number)
    return slice(y - top, y - top + height), slice(x - left, x - left + width)


def network_weights(spec: ModelSpec) -> int:
    """Number of weights of a network that travels in the stream."""
    context = spec.context
    if context.prior:
        return 0
    return context.hidden * sum(input_count(spec, step) for step in range(len(context.steps)))
