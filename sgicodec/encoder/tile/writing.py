"""A tile as a stream has it: its chunk, and a stream of it alone, to measure it."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass, replace

import numpy as np

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import write_tile
from sgicodec.bitstream.parts.tile_chunk import ExactSamples, encode_tile_chunk
from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.tile.state import Tile, TileState
from sgicodec.metrics.psnr import psnr
from sgicodec.metrics.visual_score import visual_score
from sgicodec.model.context import input_count
from sgicodec.model.spec import ModelSpec
from sgicodec.picture import Picture, comparable, to_rgb8
from sgicodec.rate_control.target import Measured, RateTarget

__all__ = ["WrittenTile", "decoded", "measured", "network_weights", "stream_of", "write", "write_nothing"]


@dataclass(frozen=True)
class WrittenTile:
    """header: the stream's, which the only tile changes; chunk: the payload of chunk T, `model` the part of it that
    says what is rendered, None for nothing; part_bytes: what each part costs; seeds: how many; lmbda: of the encode.
    """

    header: Header
    chunk: bytes
    model: bytes | None
    part_bytes: dict[str, float]
    seeds: int
    lmbda: float


def write(state: TileState) -> WrittenTile:
    """The tile as its stream has it."""
    tile, header, model = state.tile, state.header, state.model
    if tile.is_only:  # a header says no more than there is
        spec = header.spec
        texture = spec.texture and model.texture is not None
        restoration = spec.restoration and model.restoration is not None
        header = replace(header, spec=replace(spec, texture=texture, restoration=restoration))
    payload, writer = write_tile(header, model)
    parts = {name: bits / 8 for name, bits in writer.bits.items()}
    return _written(tile, header, payload, parts, len(model.layout), state.lmbda)


def write_nothing(tile: Tile) -> WrittenTile:
    """A tile that holds nothing."""
    return _written(tile, tile.header, None, {}, 0, tile.fit.lmbda)


def _written(
    tile: Tile, header: Header, model: bytes | None, parts: dict[str, float], seeds: int, lmbda: float
) -> WrittenTile:
    header = header if tile.is_only else tile.plan.header
    chunk = _chunk(tile, header, tile.number, model)
    if header.masked is not None or header.has_exact:
        parts["mask"] = len(chunk) - len(model or b"")
    return WrittenTile(header, chunk, model, parts, seeds, lmbda)


def measured(written: WrittenTile, tile: Tile, target: RateTarget) -> Measured:
    """What the stream of the only tile is; of its PSNR and score, only what is asked for."""
    data = stream_of(written, tile)
    if target.psnr is not None:
        shown = np.array(True) if tile.empty is None else ~tile.empty[..., None]
        pictures = (tile.picture, _decoded(data, tile))
        return Measured(len(data), psnr(*(np.where(shown, comparable(picture), 0) for picture in pictures)))
    if target.score is not None:
        seen, shown = to_rgb8(tile.picture), to_rgb8(_decoded(data, tile))
        return Measured(len(data), math.inf, visual_score(seen, shown, tile.device))
    return Measured(len(data), math.inf)


def stream_of(written: WrittenTile, tile: Tile) -> bytes:
    """The stream of the only tile; of one of several, a stream that holds it alone."""
    header, chunk, metadata = written.header, written.chunk, tile.plan.metadata
    if not tile.is_only:
        header, metadata = tile.header, None
        chunk = _chunk(tile, header, 0, written.model)
    buffer = io.BytesIO()
    write_stream(buffer, header, tile.plan.software, metadata, [chunk])
    return buffer.getvalue()


def decoded(written: WrittenTile, tile: Tile) -> Picture:
    """What a decoder makes of the tile alone: beside others, it fades into them."""
    return _decoded(stream_of(written, tile), tile)


def _decoded(data: bytes, tile: Tile) -> Picture:
    with open_stream(data, tile.device.processor) as stream:
        return stream.picture()


def _chunk(tile: Tile, header: Header, number: int, model: bytes | None) -> bytes:
    """The payload of chunk T of a model, None for nothing."""
    empty = tile.empty if header.masked == "transparent" else tile.bare.nodata
    exact = None
    if tile.bare.exact is not None:
        places = np.flatnonzero(tile.bare.exact)
        exact = ExactSamples(places, tile.picture.pixels[..., : tile.picture.alpha].reshape(-1)[places])
    return encode_tile_chunk(header, number, empty, model, exact)


def network_weights(spec: ModelSpec) -> int:
    """Number of weights of a network that travels in the stream."""
    context = spec.context
    if context.prior:
        return 0
    return context.hidden * sum(input_count(spec, step) for step in range(len(context.steps)))
