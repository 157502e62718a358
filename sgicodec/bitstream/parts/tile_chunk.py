"""The payload of chunk T: a tile's number where there are several, its masks and exact samples, its model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.arrays import Mask
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.parts.mask import write_mask
from sgicodec.bitstream.varint import encode_varint

_ALL_VALID, _NONE_VALID, _SOME_VALID, _BY_BAND = 0, 1, 2, 3
_BAND_VALID, _BAND_EMPTY, _BAND_MASKED, _BAND_AS_BEFORE = 0, 1, 2, 3


class ExactSamples(NamedTuple):
    """Samples that are stated exactly: places (row · width + column) · colours + band, ascending, and their values."""

    places: NDArray[np.int64]
    values: NDArray[Any]


@dataclass(frozen=True)
class TileChunk:
    """masks: which pixels of the tile hold nothing, one for all bands or one for each colour, None where all of a band
    hold something; empty where all of the tile do. exact: samples by their places. model: the payload of `write_tile`,
    None where no pixel holds anything.
    """

    number: int
    masks: tuple[_native.Mask | None, ...]
    exact: dict[int, float]
    model: bytes | None


def encode_tile_chunk(
    header: Header,
    number: int,
    empty: Mask | None,
    model: bytes | None,
    exact: ExactSamples | None = None,
) -> bytes:
    """The payload of a tile. empty: which pixels [h, w] hold nothing, or which samples [h, w, colours]; None if all
    hold something. exact: None for none. model: as in `TileChunk`.
    """
    payload = encode_varint(number) if header.tile else b""
    if header.masked is not None:
        if model is None:
            return payload + encode_varint(_NONE_VALID)
        payload += encode_varint(_ALL_VALID) if empty is None else _masks(empty)
    if header.has_exact:
        payload += _exact_samples(header, exact)
    return payload + (model or b"")


def _masks(empty: Mask) -> bytes:
    """One mask, or those of bands that differ."""
    bands = [empty] if empty.ndim == 2 else [empty[..., band] for band in range(empty.shape[2])]
    if all((band == bands[0]).all() for band in bands[1:]):
        mask = write_mask(bands[0])
        return encode_varint(_SOME_VALID) + encode_varint(len(mask)) + mask
    payload = encode_varint(_BY_BAND)
    for number, band in enumerate(bands):
        if number and (band == bands[number - 1]).all():
            payload += encode_varint(_BAND_AS_BEFORE)
        elif band.all() or not band.any():
            payload += encode_varint(_BAND_EMPTY if band.all() else _BAND_VALID)
        else:
            mask = write_mask(band)
            payload += encode_varint(_BAND_MASKED) + encode_varint(len(mask)) + mask
    return payload


def _exact_samples(header: Header, exact: ExactSamples | None) -> bytes:
    if exact is None:
        return encode_varint(0)
    values = exact.values.astype(np.dtype(header.sample_type).newbyteorder("<"), copy=False)
    gaps = np.diff(exact.places, prepend=-1) - 1
    listed = (encode_varint(int(gap)) + value.tobytes() for gap, value in zip(gaps, values, strict=True))
    return encode_varint(len(values)) + b"".join(listed)


def decode_tile_chunk(header: Header, payload: bytes) -> TileChunk:
    """The parts of a payload. Raises CorruptStreamError or LimitError."""
    number, is_empty, masks, exact, model = _native.decode_tile_chunk(encode_header(header), payload)
    _, _, width, height = header.grid.rect(number)
    nothing = _native.Mask(width, height)
    if is_empty:
        return TileChunk(number, (nothing,), {}, None)
    return TileChunk(number, tuple(nothing if is_all else mask for is_all, mask in masks), dict(exact), model)
