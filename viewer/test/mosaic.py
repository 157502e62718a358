"""Writes a stream of 151 megapixels, two tiles of photographs over and over: python mosaic.py mosaic.sgi"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import sgicodec
from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.bitstream.varint import encode_varint

DATA = Path(__file__).parents[2] / "tests" / "data"
SIDE, ACROSS = 512, 24
"""Of a tile, and how many of them lie side by side."""


def photographs() -> np.ndarray:
    """Two squares side by side."""
    squares = [sgicodec.read(DATA / name).pixels[:SIDE, 128 : 128 + SIDE] for name in ("kodim13.png", "kodim23.png")]
    return np.concatenate(squares, axis=1)


def main(target: str) -> None:
    """Encodes two tiles, and a small picture of all."""
    pair = photographs()
    data = sgicodec.encode(pair, quality=75, steps=40, tile=SIDE, apron=0, overview=False)
    with sgicodec.open(data) as stream:
        models = [stream.payload(number)[1:] for number in range(2)]  # without their numbers, of one byte
        header = replace(stream.header, width=SIDE * ACROSS, height=SIDE * ACROSS)
    small = pair.reshape(SIDE // 16, 16, 2 * SIDE // 16, 16, 3).mean(axis=(1, 3)).astype(np.uint8)
    overview = sgicodec.encode(np.tile(small, (ACROSS, ACROSS // 2, 1)), quality=50, steps=20, tile=0)
    count = ACROSS * ACROSS
    tiles = (encode_varint(number) + models[number % 2] for number in range(count))
    with open(target, "wb") as file:
        write_stream(file, header, b"mosaic", None, tiles, overview)


if __name__ == "__main__":
    main(sys.argv[1])
