"""A tile as a stream has it: its chunk."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import write_tile
from sgicodec.bitstream.parts.tile_chunk import ExactSamples, encode_tile_chunk
from sgicodec.encoder.tile.state import Tile, TileState


@dataclass(frozen=True)
class EncodedTile:
    """A finished tile."""

    payload: bytes
    """Of its chunk."""
    part_bytes: dict[str, float]
    """What each part of it costs."""
    seeds: int
    length: int
    """Bytes of the payload, which may not be here."""
    lmbda: float
    """That of its texture, or of its seeds alone."""
    steps: int = 0
    """Of its fit."""
    fitted_by: str = ""
    """The name of what made the fit, empty without one."""
    header: Header | None = None
    """The stream's, where its only tile changes it."""
    ended_early: bool = False
    """Whether the caller ended its fit or search."""


def write(state: TileState) -> EncodedTile:
    """The tile as its stream has it."""
    tile, header, model = state.tile, state.header, state.model
    if tile.is_only:  # a header says no more than there is
        spec = header.spec
        texture = spec.texture and model.texture is not None
        restoration = spec.restoration and model.restoration is not None
        network = header.network if restoration else b""
        header = replace(header, spec=replace(spec, texture=texture, restoration=restoration), network=network)
    header = tile.plan.stated(header)
    coded, bits = write_tile(header, model)
    parts = {name: part / 8 for name, part in bits.items()}
    return _encoded(tile, header, coded, parts, len(model.layout))


def write_nothing(tile: Tile) -> EncodedTile:
    """A tile that holds nothing."""
    return _encoded(tile, tile.header, None, {}, 0)


def _encoded(tile: Tile, header: Header, coded: bytes | None, parts: dict[str, float], seeds: int) -> EncodedTile:
    """The tile with this model, None for nothing."""
    stream_header = header if tile.is_only else tile.plan.stated(tile.plan.header)
    payload = _chunk(tile, stream_header, tile.number, coded)
    if stream_header.masked is not None or stream_header.has_exact:
        parts["mask"] = len(payload) - len(coded or b"")
    stated = header if tile.is_only else None
    return EncodedTile(payload, parts, seeds, len(payload), tile.texture_lmbda, header=stated)


def _chunk(tile: Tile, header: Header, number: int, coded: bytes | None) -> bytes:
    """The payload of chunk T of a model, None for nothing."""
    empty = tile.empty if header.masked == "transparent" else tile.bare.nodata
    exact = None
    if tile.bare.exact is not None:
        places = np.flatnonzero(tile.bare.exact)
        exact = ExactSamples(places, tile.picture.pixels[..., : tile.picture.alpha].reshape(-1)[places])
    return encode_tile_chunk(header, number, empty, coded, exact)
