"""Streams in xarray, by its entry point: `open_dataset(engine="sgicodec")`, and `open_datatree` for all levels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import require

require("xarray", "the plugin for xarray", "arrays")

import xarray  # noqa: E402
from xarray.backends import BackendArray, BackendEntrypoint  # noqa: E402
from xarray.core import indexing  # noqa: E402

from sgicodec.bitstream.recognition import looks_like_stream  # noqa: E402
from sgicodec.decoder.stream import Stream, open_stream  # noqa: E402
from sgicodec.metadata.gdal_items import band_facts  # noqa: E402
from sgicodec.metadata.georeference import georeference, resolution  # noqa: E402
from sgicodec.metadata.placement import transformation  # noqa: E402
from sgicodec.plugins.level_array import LevelArray  # noqa: E402

_NAME = "image"
"""Of the variable."""


class SgiBackend(BackendEntrypoint):
    """A dataset has the variable `image` over y and x, and band where there are several.

    Coordinates are those of the pixels' centres: on the map where the picture lies upright on one, else in pixels of
    the picture at its own scale. So those of all levels fit together.
    """

    description = "Streams of sgicodec, any level of them"
    supports_groups = True

    def open_dataset(self, filename_or_obj: Any, *, drop_variables: Any = None, level: int = 0) -> xarray.Dataset:
        """One level, by default the picture itself. Raises StreamError, RegionError."""
        return _dataset(open_stream(filename_or_obj), level, drop_variables)

    def open_groups_as_dict(self, filename_or_obj: Any, *, drop_variables: Any = None) -> dict[str, xarray.Dataset]:
        """All levels, as /scale0, /scale1 …"""
        stream = open_stream(filename_or_obj)
        found = {f"/scale{level}": _dataset(stream, level, drop_variables) for level in range(len(stream.levels))}
        return {"/": xarray.Dataset(attrs=_attributes(stream)), **found}

    def open_datatree(self, filename_or_obj: Any, *, drop_variables: Any = None) -> xarray.DataTree:
        """The same as a tree."""
        return xarray.DataTree.from_dict(self.open_groups_as_dict(filename_or_obj, drop_variables=drop_variables))

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        """Whether it begins as a stream does; pictures of Silicon Graphics are called alike. Of a URL, whether its name
        ends in .sgi: nothing is fetched.
        """
        return looks_like_stream(filename_or_obj)


class _Lazy(BackendArray):  # type: ignore[misc]
    """A level that xarray indexes; what is no integer or slice is taken from what is read."""

    def __init__(self, array: LevelArray) -> None:
        self.array, self.shape, self.dtype = array, array.shape, array.dtype

    def __getitem__(self, key: Any) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._read)

    def _read(self, key: tuple[Any, ...]) -> NDArray[Any]:
        return self.array[key]


def _dataset(stream: Stream, level: int, drop_variables: Any) -> xarray.Dataset:
    array = LevelArray(stream, level)
    names = ("y", "x", "band")[: array.ndim]
    data = indexing.LazilyIndexedArray(_Lazy(array))
    attributes = _attributes(stream)
    encoding = {"preferred_chunks": dict(zip(names, array.chunks, strict=True))}
    variable = xarray.Variable(names, data, attributes | _band_attributes(stream), encoding)
    y, x = _coordinates(stream, level)
    dropped = {drop_variables} if isinstance(drop_variables, str) else set(drop_variables or ())
    variables = {name: found for name, found in {_NAME: variable}.items() if name not in dropped}
    dataset = xarray.Dataset(variables, {"y": y, "x": x}, attributes)
    dataset.set_close(stream.close)
    return dataset


def _coordinates(stream: Stream, level: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    found = stream.levels[level]
    y = (np.arange(found.height) + 0.5) * stream.height / found.height
    x = (np.arange(found.width) + 0.5) * stream.width / found.width
    matrix = transformation(stream.metadata.geo)
    if matrix is None or matrix[0, 1] or matrix[1, 0]:
        return y, x
    return matrix[1, 1] * y + matrix[1, 2], matrix[0, 0] * x + matrix[0, 2]


def _band_attributes(stream: Stream) -> dict[str, Any]:
    """Names, units, scales and offsets of bands, as far as the tags state any. Where bands differ in scale or offset,
    both stand under names that no decoder of conventions applies to all bands.
    """
    bands = band_facts(stream.metadata.geo, stream.header.spec.channels)
    scales = [1.0 if band.scale is None else band.scale for band in bands]
    offsets = [0.0 if band.offset is None else band.offset for band in bands]
    stated = {
        "long_name": _for_all([band.description or "" for band in bands]),
        "units": _for_all([band.unit or "" for band in bands]),
    }
    if len(set(scales)) > 1 or len(set(offsets)) > 1:
        stated |= {"scales": scales, "offsets": offsets}
    elif (scales[0], offsets[0]) != (1, 0):
        stated |= {"scale_factor": scales[0], "add_offset": offsets[0]}
    return {name: value for name, value in stated.items() if value != ""}


def _for_all(texts: list[str]) -> Any:
    """One text where all are equal, else all of them."""
    return texts[0] if len(set(texts)) == 1 else texts


def _attributes(stream: Stream) -> dict[str, Any]:
    """Coordinate system, nodata, size of a pixel, as far as they are stated."""
    reference = georeference(stream.metadata.geo, stream.width, stream.height)
    scale = resolution(stream.metadata.geo, stream.metadata.exif)
    name = None if reference is None else f"EPSG:{reference.epsg}" if reference.epsg else reference.name
    stated = {
        "channels": stream.header.channels,
        "crs": name,
        "_FillValue": stream.nodata,
        "microns_per_pixel": None if scale is None else list(scale.microns),
    }
    return {key: value for key, value in stated.items() if value is not None}
