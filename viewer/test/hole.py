"""Writes a stream of a picture with pixels that hold nothing: python hole.py hole.sgi"""

from __future__ import annotations

import sys
from pathlib import Path

import sgicodec
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture

DATA = Path(__file__).parents[2] / "tests" / "data"


def main(target: str) -> None:
    """Encodes a corner of a photograph whose middle is 0, the value of nothing."""
    pixels = sgicodec.read(DATA / "kodim23.png").pixels[:96, :128].copy()
    pixels[20:60, 30:80] = 0
    place = geo.pack({42113: ifd.Entry(2, b"0\0")})
    picture = Picture(pixels, "rgb", (0.0, 255.0), Metadata(geo=place))
    Path(target).write_bytes(sgicodec.encode_picture(picture, sgicodec.EncodeSettings(steps=20)).data)


if __name__ == "__main__":
    main(sys.argv[1])
