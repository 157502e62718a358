"""Masks and exact samples of a tile come back, and damaged ones are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import GOLDEN
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sgicodec._native import Mask
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile_chunk import ExactSamples, decode_tile_chunk, encode_tile_chunk
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError

PLAIN = open_stream((GOLDEN / "rgb8.sgi").read_bytes()).header
MODEL = b"model"


def header_of(dtype: str, width: int, height: int, exact: bool = True) -> Header:
    sample_range = {"uint8": (0.0, 255.0), "uint16": (0.0, 4095.0), "float32": (-1.0, 1.0)}[dtype]
    sized = replace(PLAIN, width=width, height=height, sample_type=dtype, sample_range=sample_range)
    return replace(sized, masked="nodata", nodata=0.0, has_band_masks=True, has_exact=exact)


def pixels(mask: Mask | None, width: int, height: int) -> np.ndarray:
    empty = np.zeros((height, width), np.bool_)
    return empty if mask is None else mask.at(np.arange(height), np.arange(width))


@given(st.data())
def test_what_is_written_is_read(data: st.DataObject) -> None:
    width, height = data.draw(st.integers(1, 20)), data.draw(st.integers(1, 20))
    dtype = data.draw(st.sampled_from(["uint8", "uint16", "float32"]))
    empty = data.draw(arrays(np.bool_, (height, width, 3), elements=st.booleans(), fill=st.booleans()))
    whole = data.draw(st.sampled_from([(), (0,), (1, 2), (0, 1)]))
    empty[..., list(whole)] = data.draw(st.booleans())
    if empty.all():
        empty[0, 0, 0] = False
    places = np.array(sorted(data.draw(st.sets(st.integers(0, width * height * 3 - 1), max_size=9))), np.int64)
    values = data.draw(arrays(dtype, len(places)))
    header = header_of(dtype, width, height)
    payload = encode_tile_chunk(header, 0, empty if empty.any() else None, MODEL, ExactSamples(places, values))
    chunk = decode_tile_chunk(header, payload)
    assert chunk.model == MODEL
    bands = [pixels(mask, width, height) for mask in chunk.masks] or [np.zeros((height, width), np.bool_)]
    np.testing.assert_array_equal(np.stack(bands * (3 // len(bands)), axis=-1), empty)
    assert list(chunk.exact) == places.tolist()
    np.testing.assert_array_equal(np.array(list(chunk.exact.values())), values.astype(np.float64))


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"\4", "a mask of an unknown kind"),
        (b"\3\3", "a band's mask of an unknown kind"),
        (b"\3\1\4", "a band's mask of an unknown kind"),
        (b"\3\1\3\3\0", "all the same"),
        (b"\0\1\0", "ends inside its exact samples"),
        (b"\0\2\0\7", "more exact samples than bytes|outside the tile|varint"),
        (b"\0\1" + encode_varint(192) + b"\7", "outside the tile"),
        (b"\0\2" + encode_varint(191) + b"\7\0\7", "outside the tile"),
        (b"\0" + encode_varint(1 << 40), "more exact samples than bytes"),
    ],
)
def test_what_no_encoder_writes_is_refused(payload: bytes, message: str) -> None:
    with pytest.raises(CorruptStreamError, match=message):
        decode_tile_chunk(header_of("uint8", 8, 8), payload)
