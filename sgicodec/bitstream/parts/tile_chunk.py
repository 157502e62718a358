"""The payload of chunk T: a tile's number where there are several, its mask where there is one, its model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec._native import MaskTree
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.parts.mask import write_mask
from sgicodec.bitstream.varint import encode_varint

__all__ = ["TileChunk", "decode_tile_chunk", "encode_tile_chunk"]

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


def decode_tile_chunk(header: Header, payload: bytes) -> TileChunk:
    """The parts of a payload. Raises CorruptStreamError or LimitError."""
    number, is_empty, mask, model = _native.decode_tile_chunk(encode_header(header), payload)
    if not is_empty:
        return TileChunk(number, mask, model)
    _, _, width, height = header.grid.rect(number)
    return TileChunk(number, MaskTree(width, height), None)
