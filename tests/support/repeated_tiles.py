"""Streams of many tiles that take the time of encoding two."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np

import sgicodec
from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.bitstream.varint import encode_varint

TILE = 64
"""Their side, in pixels."""


def repeated_tiles(rows: int, columns: int) -> bytes:
    """A stream of two tiles of noise over and over, without an overview."""
    pixels = np.random.default_rng(2).integers(0, 256, (TILE, 2 * TILE, 3), np.uint8)
    pair = sgicodec.encode(pixels, quality=95, tune="psnr", steps=2, tile=TILE, apron=0, overview=False, rdoq=False)
    with sgicodec.open(pair) as stream:
        models = [stream.payload(number)[1:] for number in range(2)]  # without their numbers, of one byte
        header = replace(stream.header, width=columns * TILE, height=rows * TILE)
    file = io.BytesIO()
    tiles = (encode_varint(number) + models[number % 2] for number in range(rows * columns))
    write_stream(file, header, b"", None, tiles, None)
    return file.getvalue()
