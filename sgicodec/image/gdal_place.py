"""Where a picture lies, as GDAL (rasterio) reads it: for JPEG 2000 whose place GML alone states, as of Sentinel-2."""

from __future__ import annotations

import warnings
from pathlib import Path

from sgicodec.errors import has_library
from sgicodec.metadata import tiff

_ENVIRONMENT = {"GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "GDAL_PAM_ENABLED": False}
"""Files beside the picture say nothing of it."""


def place_by_gdal(path: Path) -> bytes | None:
    """The `geo` blob; None without rasterio, and where it finds no place."""
    if not has_library("rasterio"):
        return None
    import rasterio
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    form = {"driver": "GTiff", "width": 1, "height": 1, "count": 1, "dtype": "uint8"}
    try:
        with rasterio.Env(**_ENVIRONMENT), warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as file:
                crs, transform = file.crs, file.transform
            if crs is None and transform.is_identity:
                return None
            with rasterio.MemoryFile() as memory:
                with memory.open(**form, crs=crs, transform=transform):
                    pass
                return tiff.find(memory.read())[2]
    except RasterioError:
        return None
