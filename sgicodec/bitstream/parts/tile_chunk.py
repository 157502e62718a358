"""The payload of chunk T: a tile's number where there are several, its mask where there is one, its model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.mask import read_mask, write_mask
from sgicodec.bitstream.parts.mask_tree import MaskTree
from sgicodec.bitstream.varint import decode_varint, encode_varint
from sgicodec.errors import CorruptStreamError

__all__ = ["TileChunk", "decode_tile_chunk", "encode_tile_chunk", "tile_number"]

Mask = NDArray[np.bool_]

_ALL_VALID, _NONE_VALID, _SOME_VALID = 0, 1, 2


@dataclass(frozen=True)
class TileChunk:
    """mask: which pixels of the tile hold nothing, None if all hold something. model: the payload of `write_tile`, None
    where no pixel holds anything.
    """

    number: int
    mask: MaskTree | None
    model: bytes | None


def encode_tile_chunk(header: Header, number: int, empty: Mask | None, model: bytes | None) -> bytes:
    """The payload of a tile. empty: which pixels [h, w] hold nothing, None if all hold something; model: as in
    `TileChunk`.
    """
    payload = encode_varint(number) if header.tile else b""
    if header.masked is not None:
        if model is None:
            return payload + encode_varint(_NONE_VALID)
        if empty is None:
            payload += encode_varint(_ALL_VALID)
        else:
            mask = write_mask(empty)
            payload += encode_varint(_SOME_VALID) + encode_varint(len(mask)) + mask
    return payload + (model or b"")


def tile_number(header: Header, start: bytes) -> int:
    """The number of the tile whose payload begins so. Raises CorruptStreamError."""
    number = decode_varint(start, 0)[0] if header.tile else 0
    if number >= header.grid.count:
        raise CorruptStreamError(f"tile {number} in a stream of {header.grid.count}")
    return number


def decode_tile_chunk(header: Header, payload: bytes) -> TileChunk:
    """The parts of a payload. Raises CorruptStreamError."""
    number, at = tile_number(header, payload), 0
    if header.tile:
        _, at = decode_varint(payload, at)
    if header.masked is None:
        return TileChunk(number, None, payload[at:])
    kind, at = decode_varint(payload, at)
    _, _, width, height = header.grid.rect(number)
    if kind == _NONE_VALID and at == len(payload):
        return TileChunk(number, MaskTree(width, height), None)
    if kind == _ALL_VALID:
        return TileChunk(number, None, payload[at:])
    if kind != _SOME_VALID:
        raise CorruptStreamError(f"tile {number}: a mask of an unknown kind; the stream is damaged")
    length, at = decode_varint(payload, at)
    if at + length > len(payload):
        raise CorruptStreamError(f"tile {number}: ends inside its mask; the stream is damaged")
    mask = read_mask(payload[at : at + length], width, height)
    if not mask.is_mixed:
        raise CorruptStreamError(f"tile {number}: a mask that says nothing; the stream is damaged")
    return TileChunk(number, mask, payload[at + length :])
