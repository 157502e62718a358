"""TIFF files whose samples OpenImageIO cannot read, by GDAL (rasterio)."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sgicodec.arrays import Samples
from sgicodec.errors import MissingExtraError, PictureError, require
from sgicodec.image.decoded_picture import Reader
from sgicodec.image.inks import rgb_of_inks
from sgicodec.metadata import ifd

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

    from sgicodec.metadata.filebytes import Bytes


_COMPRESSION, _STRIPS, _STRIP_BYTES, _TILES, _TILE_BYTES = 259, 273, 279, 324, 325
_PHOTOMETRIC, _SAMPLES, _COLOURS = 262, 277, 320
_JPEG, _SHOWN = 7, (1, 3)
"""Of JPEG, OpenImageIO has libtiff make what a screen shows, RGB and alpha; so many bands come as they are."""
_KNOWN = (0, 1, 2, 3, 4, 5, 6, 7, 8, 32766, 32771, 32773, 32809, 32946, 34676, 34677, 50001)
"""Compressions that OpenImageIO's libtiff reads; 0 where none is stated."""
_NAMES = {50000: "ZSTD", 34887: "LERC", 34925: "LZMA", 50002: "JPEG XL", 52546: "JPEG XL", 34712: "JPEG 2000"}

_WIDTHS = {3: 2, 4: 4, 16: 8}
"""Bytes of the integers that offsets and lengths of strips and tiles are."""

_WHITE_IS_ZERO, _PALETTE, _INKS = 0, 3, 5
_TYPES = {"half": "float16", "float": "float32", "double": "float64", "int": "int32", "uint": "uint32"}
_ENVIRONMENT = {"GDAL_CACHEMAX": 64, "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "GDAL_PAM_ENABLED": False}
"""MiB of decoded blocks; files beside the picture say nothing of it."""

_PROGRAM = "convert it first, as with gdal_translate -co COMPRESS=DEFLATE IN a.tif"


def left_to_gdal(data: Bytes) -> str | None:
    """Why OpenImageIO does not read the samples of the first page of a TIFF file; None if it does."""
    asked = {_COMPRESSION, _STRIPS, _STRIP_BYTES, _TILES, _TILE_BYTES, _PHOTOMETRIC, _SAMPLES, _COLOURS}
    found = ifd.entries(data, asked)
    compression = found[_COMPRESSION].short if _COMPRESSION in found else 0
    if compression not in _KNOWN:
        return f"it is compressed by {_NAMES.get(compression, f'method {compression}')}"
    photometric = found[_PHOTOMETRIC].short if _PHOTOMETRIC in found else None
    bands = found[_SAMPLES].short if _SAMPLES in found else 1
    if compression == _JPEG and bands not in _SHOWN and photometric != _INKS:
        return f"it is compressed by JPEG in {bands} bands"
    for offsets, lengths in ((_STRIPS, _STRIP_BYTES), (_TILES, _TILE_BYTES)):
        at, size = _numbers(found.get(offsets)), _numbers(found.get(lengths))
        if len(at) == len(size) and ((at == 0) & (size == 0)).any():
            return "it is sparse, some of its strips or tiles are not there"
    colours = _numbers(found.get(_COLOURS))
    if photometric == _PALETTE and 0 < colours.max(initial=0) < 256:
        return "the colours of its palette have 8 bits"  # of 16, of which OpenImageIO makes black
    return None


def _numbers(entry: ifd.Entry | None) -> npt.NDArray[np.unsignedinteger[Any]]:
    width = 0 if entry is None else _WIDTHS.get(entry.kind, 0)
    return np.frombuffer(entry.data, f"<u{width}") if entry and width else np.empty(0, np.uint8)


class TiffReader(Reader):
    """An open page, whose samples come as OpenImageIO would give them: stretched to 8 or 16 bits, 8 bits of which 0 is
    white turned over, palettes and inks as RGB. What is not there is 0 or the nodata value.
    """

    kind = "tiff"

    def __init__(self, path: Path, number: int, header: ImageSpec, reason: str) -> None:
        """number: of the page's directory, from 0; header: OpenImageIO's; reason: as `left_to_gdal` says.

        Raises PictureError for what GDAL does not read either, or without rasterio.
        """
        try:
            require("rasterio", "reading it", "tiff")
        except MissingExtraError as error:
            raise PictureError(f"{reason}; {error}, or {_PROGRAM}") from None
        import rasterio
        from rasterio.errors import NotGeoreferencedWarning, RasterioError

        self._header, self._reason = header, reason
        try:
            with rasterio.Env(**_ENVIRONMENT), warnings.catch_warnings():
                warnings.simplefilter("ignore", NotGeoreferencedWarning)
                self._file = rasterio.open(f"GTIFF_DIR:{number + 1}:{path}", driver="GTiff")
        except RasterioError as error:
            raise PictureError(f"{reason}, and GDAL does not read it; {_PROGRAM}") from error
        self._photometric = header.get_int_attribute("tiff:PhotometricInterpretation", -1)
        self._bits = header.get_int_attribute("oiio:BitsPerSample", 0)
        self._type = np.dtype(_TYPES.get(str(header.format), str(header.format)))

    def spec(self) -> ImageSpec:
        """OpenImageIO's header."""
        return self._header

    def read_tiles(self, _: int, __: int, left: int, right: int, top: int, bottom: int, *___: Any) -> Samples:
        """Pixels [h, w, C] from column left to right, row top to bottom. Raises PictureError."""
        import rasterio
        from rasterio.errors import RasterioError
        from rasterio.windows import Window

        window = Window(left - self._header.x, top - self._header.y, right - left, bottom - top)
        try:
            with rasterio.Env(**_ENVIRONMENT):
                samples = self._file.read(window=window)
        except RasterioError as error:
            said = " ".join(str(error.__cause__ or error).split())
            raise PictureError(f"the file is damaged or cut off: {said}") from error
        return np.ascontiguousarray(self._as_read(np.moveaxis(samples, 0, -1)))

    def read_scanlines(self, _: int, __: int, top: int, bottom: int, *___: Any) -> Samples:
        """Rows [h, W, C]. Raises PictureError."""
        left = self._header.x
        return self.read_tiles(0, 0, left, left + self._header.width, top, bottom)

    def _as_read(self, samples: Samples) -> Samples:
        """Samples [h, w, bands] of GDAL as OpenImageIO's."""
        count, full = self._header.nchannels, 8 * self._type.itemsize
        if self._photometric == _PALETTE:
            entries = self._file.colormap(1)
            colours = np.array([entries.get(index, (0, 0, 0, 255)) for index in range(1 << self._bits)], np.uint8)
            return colours[samples[..., 0], :count]
        if self._type.kind == "u" and 0 < self._bits < full <= 16:
            samples = samples.astype(np.uint32) * ((1 << full) - 1) // ((1 << self._bits) - 1)
        samples = samples.astype(self._type, copy=False)
        if self._photometric == _WHITE_IS_ZERO and self._type == np.uint8:
            samples = 255 - samples
        if (
            self._photometric == _INKS and count == 3 and self._file.colorinterp[0].name != "red"
        ):  # GDAL has not done so
            return rgb_of_inks(samples[..., :4])
        if samples.shape[-1] < count:
            raise PictureError(
                f"{self._reason}, and GDAL finds {samples.shape[-1]} of its {count} channels; {_PROGRAM}"
            )
        return samples[..., :count]

    def close(self) -> None:
        """Close the file."""
        self._file.close()
