"""Samples in another type than the source's: what the header of such a picture is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import DTypeLike

from sgicodec.bitstream.header import Header
from sgicodec.errors import UsageError
from sgicodec.picture import full_range


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
    """Where nodata goes; 0 for one that lies outside the range of samples, or is not a number, or where bands have
    ranges of their own.
    """
    low, high = header.sample_range
    if isinstance(low, tuple) or isinstance(high, tuple):
        return 0.0
    most = full_range(dtype)[1]
    value = most * (nodata - low) / (high - low) if low <= nodata <= high else 0.0
    return float(np.rint(value) if dtype != "float32" else np.float32(value))
