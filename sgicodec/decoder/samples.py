"""Samples in another type than the source's: what the header and the metadata of such a picture are."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import DTypeLike

from sgicodec.bitstream.header import Header
from sgicodec.decoder.view import View
from sgicodec.errors import UsageError
from sgicodec.metadata import geo
from sgicodec.metadata.exif import rescaled
from sgicodec.picture import Metadata, full_range

__all__ = ["converted", "placed"]


class _Stream(Protocol):
    header: Header
    metadata: Metadata

    @property
    def nodata(self) -> float | None: ...


def converted(header: Header, nodata: float | None, dtype: DTypeLike) -> Header:
    """The header of the same picture in uint8, uint16 or float32, whose range of samples is that of the type. Nodata
    becomes the value next to it. Raises UsageError for another type.
    """
    try:
        name = np.dtype(dtype).name
    except TypeError:
        name = str(dtype)
    if name not in ("uint8", "uint16", "float32"):
        raise UsageError(f"dtype {name}; samples are uint8, uint16 or float32")
    if name == header.sample_type:
        return header
    value = 0.0 if nodata is None else _converted_nodata(header, nodata, name)
    return replace(header, sample_type=name, sample_range=full_range(name), nodata=value)


def _converted_nodata(header: Header, nodata: float, dtype: str) -> float:
    """Where nodata goes; 0 for one that lies outside the range of samples, or is not a number."""
    low, high = header.sample_range
    most = full_range(dtype)[1]
    value = most * (nodata - low) / (high - low) if low <= nodata <= high else 0.0
    return float(np.rint(value) if dtype != "float32" else np.float32(value))


def placed(stream: _Stream, header: Header, view: View) -> Metadata:
    """The metadata of what a view shows, in samples as of `header`."""
    found = stream.metadata
    if found.exif is not None and (view.sx, view.sy) != (1, 1):
        found = replace(found, exif=rescaled(found.exif, view.sx, view.sy))
    if found.geo is None:
        return found
    from sgicodec.metadata.placement import view as geo_view  # takes long to load

    place = geo_view(found.geo, view.x, view.y, view.sx, view.sy)
    if header.sample_type != stream.header.sample_type:
        place = geo.resampled(place, lambda _: header.nodata)
    return replace(found, geo=place)
