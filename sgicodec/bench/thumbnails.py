"""What thumbnails lose that draw the base layer alone: python -m sgicodec.bench.thumbnails STREAM…"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

from sgicodec import decoder
from sgicodec.metrics import psnr

__all__ = ["main", "thumbnail"]

SCALES = (16, 24, 32, 48, 64)


def thumbnail(path: str, shrink: int, base_alone: bool) -> NDArray[np.float32]:
    """A stream of several tiles at 1 / shrink, by its base layer or by the whole model."""
    usual = decoder.BASE_ALONE
    decoder.BASE_ALONE = float("inf") if base_alone else 0.0
    try:
        with decoder.open_stream(path) as stream:
            return np.clip(stream.render(scale=1 / shrink), 0, 1)
    finally:
        decoder.BASE_ALONE = usual


def main(paths: list[str]) -> None:
    """Prints for each stream the PSNR of one against the other at all SCALES."""
    for path in paths:
        for shrink in SCALES:
            score = psnr(thumbnail(path, shrink, False), thumbnail(path, shrink, True))
            print(f"{path}  1/{shrink}  {score:.1f} dB")


if __name__ == "__main__":
    main(sys.argv[1:])
