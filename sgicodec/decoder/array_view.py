"""A stream as an array, and as a slide with levels: what numpy, Dask, rasterio and OpenSlide call the parts of one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sgicodec.bitstream.header import Header
from sgicodec.decoder.indexing import indexed_region
from sgicodec.decoder.levels import Level, levels_of
from sgicodec.decoder.view import Region, Size, View, level_view, region_of_level
from sgicodec.errors import UsageError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import DTypeLike, NDArray

    from sgicodec.picture import Picture


class ArrayView:
    """The base of `Stream`: all that follows from its header, from `picture` and from `_draw`."""

    header: Header

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array that `read` gives: (H, W) of gray, else (H, W, C)."""
        header = self.header
        bands = () if header.channels == "gray" else (header.spec.channels,)
        return (header.height, header.width, *bands)

    @property
    def ndim(self) -> int:
        """2 or 3."""
        return len(self.shape)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of the source's samples: uint8, uint16 or float32."""
        import numpy as np

        return np.dtype(self.header.sample_type)

    @property
    def levels(self) -> tuple[Level, ...]:
        """Width, height and downsampling of a pyramid: the picture, its half, its quarter … down to 256 pixels."""
        return levels_of(self.header.width, self.header.height)

    def read(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: Size | None = None,
        dtype: DTypeLike | None = None,
        boundless: bool = False,
    ) -> NDArray[Any]:
        """The same as an array: [h, w] of gray, else [h, w, C]."""
        return self._array(self.picture(region, scale, size, dtype, boundless).pixels)

    def read_region(self, location: tuple[int, int], level: int, size: tuple[int, int]) -> NDArray[Any]:
        """As of OpenSlide: `size` (width, height) pixels of a level in `levels`, from `location` (x, y) on.

        The location counts pixels of the picture. What lies outside it is nodata, else 0. An array as of `read`.
        """
        view = level_view(self.header, self.levels, location, level, size)
        return self._array(self._draw(view, self.header.sample_type, 0, view.rows))

    def read_level(self, level: int, region: Region | None = None) -> NDArray[Any]:
        """A level in `levels`, or a region (x, y, width, height) of it in its own pixels, as of `read`.

        Parts differ from the whole by roundings.
        """
        view = region_of_level(self.header, self.levels, level, region)
        return self._array(self._draw(view, self.header.sample_type, 0, view.rows))

    def __getitem__(self, key: Any) -> NDArray[Any]:
        """Integers and slices as into an array of `shape`; only the region that they touch is decoded."""
        region, index = indexed_region(key, self.shape)
        if 0 in region[2:]:
            import numpy as np

            return np.empty((region[3], region[2], *self.shape[2:]), self.dtype)[index]
        return self.read(region)[index]

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """All samples, for numpy.asarray."""
        if copy is False:
            raise UsageError("decoding makes a new array; copy=False cannot be had")
        samples = self.read()
        return samples if dtype is None else samples.astype(dtype, copy=False)

    def _array(self, pixels: NDArray[Any]) -> NDArray[Any]:
        return pixels[..., 0] if self.header.channels == "gray" else pixels

    def picture(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: Size | None = None,
        dtype: DTypeLike | None = None,
        boundless: bool = False,
    ) -> Picture:
        """See `Stream`."""
        raise NotImplementedError

    def _draw(self, view: View, sample_type: str, top: int, rows: int) -> NDArray[Any]:
        raise NotImplementedError
