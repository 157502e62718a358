"""Which pixels of a TIFF's tiles have content, as the mask that GDAL reads beside them: bits, not a nodata value."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray


class ContentMask:
    """The mask of a level, gathered while its tiles pass by; compressed, as a level may be larger than memory.

    nodata: the sample that a pixel without content has in all channels.
    """

    def __init__(self, nodata: float) -> None:
        self._nodata = nodata
        self._kept: list[tuple[tuple[int, ...], bytes]] = []

    def passing(self, tiles: Iterator[NDArray[Any]]) -> Iterator[NDArray[Any]]:
        """The same tiles [h, w] or [h, w, C]."""
        for tile in tiles:
            blank = np.isnan(tile) if np.isnan(self._nodata) else tile == self._nodata
            content = ~(blank.all(axis=2) if blank.ndim == 3 else blank)
            self._kept.append((content.shape, zlib.compress(np.packbits(content).tobytes())))
            yield tile

    def tiles(self) -> Iterator[NDArray[np.bool_]]:
        """Whether pixels have content, [h, w], in the order in which tiles have passed."""
        for shape, data in self._kept:
            bits = np.unpackbits(np.frombuffer(zlib.decompress(data), np.uint8), count=shape[0] * shape[1])
            yield bits.astype(bool).reshape(shape)
