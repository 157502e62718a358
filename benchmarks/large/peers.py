"""The codecs that large pictures are compared with: from a picture file to a file, and back to pixels in bands.

Qualities are numbered: rung 0 is the coarsest, and a higher rung is never coarser.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from benchmarks.large.jpeg_tiff import TILE, write_jpeg_tiff
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peer import Peer
from sgicodec.bench.peers import Avif, Jpeg, JpegXl
from sgicodec.image import Source, open_source
from sgicodec.model.tile_grid import Rect

__all__ = ["LARGE_PEERS", "JpegTiff", "LargePeer", "WholePeer"]

BAND = 256
"""Rows that are read or written at once."""

_DISTANCES_PER_OCTAVE = 16


class LargePeer(ABC):
    """A codec of files. `region_note` says how it gets at a region."""

    name: ClassVar[str]
    rungs: ClassVar[int]
    region_note: ClassVar[str]

    @abstractmethod
    def version(self) -> str: ...

    @abstractmethod
    def settings(self, rung: int) -> str: ...

    @abstractmethod
    def encode(self, picture: Path, out: Path, rung: int) -> None:
        """Codes a picture file of 8-bit RGB. Raises what its library raises."""

    @abstractmethod
    def bands(self, path: Path, region: Rect) -> Iterator[Pixels8]:
        """Decoded rows [n, W, 3] of a region from the top down."""


class JpegTiff(LargePeer):
    """JPEG in a tiled TIFF: 4:2:0, tiles of 256×256."""

    name = "jpeg-tiff"
    rungs = 100
    region_note = "region by its tiles"

    def version(self) -> str:
        return Jpeg().version()

    def settings(self, rung: int) -> str:
        return f"quality={rung + 1} 4:2:0 tile={TILE}"

    def encode(self, picture: Path, out: Path, rung: int) -> None:
        with open_source(picture) as source:
            write_jpeg_tiff(source, out, rung + 1)

    def bands(self, path: Path, region: Rect) -> Iterator[Pixels8]:
        with open_source(path) as source:
            yield from _rows(source, region)


@dataclass
class WholePeer(LargePeer):
    """A codec whose library takes and gives whole arrays; a region is cut out of all pixels."""

    peer: Peer

    region_note = "region by decoding all (its Python binding has no other way)"

    @abstractmethod
    def quality(self, rung: int) -> float:
        """What the peer calls this rung."""

    def version(self) -> str:
        return self.peer.version()

    def settings(self, rung: int) -> str:
        return self.peer.settings(self.quality(rung))

    def encode(self, picture: Path, out: Path, rung: int) -> None:
        with open_source(picture) as source:
            pixels = np.empty((source.height, source.width, 3), np.uint8)
            y = 0
            for rows in _rows(source, (0, 0, source.width, source.height)):
                pixels[y : y + len(rows)] = rows
                y += len(rows)
        out.write_bytes(self.peer.encode(pixels, self.quality(rung)))

    def bands(self, path: Path, region: Rect) -> Iterator[Pixels8]:
        with _no_pixel_limit():
            pixels = self.peer.decode(path.read_bytes())
        x, y, width, height = region
        for top in range(y, y + height, BAND):
            yield pixels[top : min(top + BAND, y + height), x : x + width]


class LargeJpegXl(WholePeer):
    """JPEG XL at effort 7; rungs are sixteenths of an octave of its distance, from 25 down to 0.05."""

    name = "jxl"
    rungs = 9 * _DISTANCES_PER_OCTAVE

    def quality(self, rung: int) -> float:
        return float(f"{25 * 2 ** (-rung / _DISTANCES_PER_OCTAVE):.4g}")


class LargeAvif(WholePeer):
    """AVIF at speed 6; rungs are its qualities."""

    name = "avif"
    rungs = 101

    def quality(self, rung: int) -> float:
        return float(rung)


LARGE_PEERS: dict[str, Callable[[int], LargePeer]] = {
    "jpeg-tiff": lambda threads: JpegTiff(),
    "jxl": lambda threads: LargeJpegXl(JpegXl(threads=threads)),
    "avif": lambda threads: LargeAvif(Avif(threads=threads, tiled=True)),
}


def _rows(source: Source, region: Rect) -> Iterator[Pixels8]:
    x, y, width, height = region
    for top in range(y, y + height, BAND):
        yield source.read(x, top, width, min(BAND, y + height - top)).pixels


@contextmanager
def _no_pixel_limit() -> Iterator[None]:
    """Pillow takes large pictures for attacks."""
    from PIL import Image

    limit, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
    try:
        yield
    finally:
        Image.MAX_IMAGE_PIXELS = limit
