"""A view of a stream in bands of rows from the top down, for pictures larger than memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from sgicodec.bitstream.header import Header
from sgicodec.decoder.view import View
from sgicodec.metadata.blobs import Metadata

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sgicodec.picture import Picture

BAND_SAMPLES = 1 << 25
_MIN_BAND_ROWS = 16
"""A band has about BAND_SAMPLES samples, and at least _MIN_BAND_ROWS rows."""

Draw = Callable[[int, int], "NDArray[Any]"]
"""Gives pixels [rows, columns, C] of what a view shows, from a row on and so many rows."""


class Bands:
    """width, height: of the view in output pixels; metadata: those of the view."""

    def __init__(self, header: Header, view: View, metadata: Metadata, draw: Draw) -> None:
        self._header, self._draw = header, draw
        self.width, self.height = view.columns, view.rows
        self.metadata = metadata

    @property
    def row_bytes(self) -> int:
        """Of the samples of a row."""
        return self.width * self._header.spec.channels * self._header.sample_bytes

    @property
    def rows(self) -> int:
        """Rows of a band; the last one may have fewer."""
        samples = self.width * self._header.spec.channels
        return min(self.height, max(_MIN_BAND_ROWS, BAND_SAMPLES // samples))

    def __iter__(self) -> Iterator[tuple[int, Picture]]:
        """First row and picture of each band."""
        header = self._header
        for top in range(0, self.height, self.rows):
            pixels = self._draw(top, min(self.rows, self.height - top))
            from sgicodec.picture import Picture  # loads numpy, and another thread may do so while it is rendered

            yield top, Picture(pixels, header.channels, header.sample_range, self.metadata, header.blank)
