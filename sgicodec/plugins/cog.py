"""Streams as Cloud Optimized GeoTIFF, by GDAL's own driver (rasterio)."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from sgicodec.decoder.stream import Stream
from sgicodec.errors import PictureError, require
from sgicodec.files.scratch import scratch_folder
from sgicodec.files.whole import whole_file
from sgicodec.metadata.gdal_items import domains
from sgicodec.plugins.compression import DEFLATE, Compression
from sgicodec.plugins.pyramid import is_masked, write_levels

_CACHE_MIB = 64

_OPTIONS = {
    "driver": "COG",
    "BLOCKSIZE": "512",
    "BIGTIFF": "IF_SAFER",
    "OVERVIEWS": "FORCE_USE_EXISTING",
}
_DOMAINS = {"COPY_SRC_MDD": "YES"}
"""To keep domains of metadata, at the price of bands' items outside of any, which GDAL 3.10 then leaves out."""


def write_cog(
    stream: Stream,
    path: str | Path,
    *,
    compression: Compression = DEFLATE,
    done: Callable[[int], None] = lambda rows: None,
    **view: Any,
) -> None:
    """Writes a stream, or a part of it, with place, nodata and overviews, as Cloud Optimized GeoTIFF. The file appears
    whole or not at all.

    compression: of the tiles. view: region, scale, size, dtype and boundless, as of `Stream.picture`. done: called with
    the rows of the picture that are rendered. Overviews are rendered by the decoder; a pyramid is written beside the
    file first, which GDAL puts in order. Raises StreamError, PictureError, UsageError, MissingExtraError.
    """
    require("rasterio", "writing Cloud Optimized GeoTIFF", "tiff")
    import rasterio
    import rasterio.shutil
    from rasterio.errors import RasterioError

    masked = is_masked(stream, compression, view)
    dtype = np.dtype(view.get("dtype") or stream.dtype)
    compression.check(stream.header.channels, dtype, None if masked else stream.nodata)
    try:
        with scratch_folder(Path(path).resolve().parent) as folder:
            unordered, ordered = folder / "pyramid.tif", folder / "cog.tif"
            with unordered.open("wb") as file:
                write_levels(stream, file, False, view, done, masked=masked)
            options = _OPTIONS | (_DOMAINS if domains(stream.metadata.geo)[0] else {}) | compression.for_gdal()
            with rasterio.Env(GDAL_CACHEMAX=_CACHE_MIB):
                rasterio.shutil.copy(unordered, ordered, **options)
            with whole_file(Path(path)) as out, ordered.open("rb") as done_file:
                shutil.copyfileobj(done_file, out)
    except RasterioError as error:
        raise PictureError(f"{path}: {' '.join(str(error).split())}") from error
    except OSError as error:
        raise PictureError(f"{path}: {error.strerror or error}") from error
