"""Pixels without content, as a decoder stores them: nodata, and nothing that looks like it beside them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.picture import equal_samples

__all__ = ["store_nodata"]


def store_nodata(header: Header, colours: NDArray[Any], empty: NDArray[np.bool_]) -> None:
    """Stores nodata in the empty pixels [h, w] of colours [h, w, C]; others that have its value go one step aside."""
    alike = ~empty & equal_samples(colours, header.nodata).all(axis=-1)
    colours[alike, 0] = _beside(header, colours.dtype)
    colours[empty] = header.nodata


def _beside(header: Header, dtype: np.dtype[Any]) -> Any:
    """The sample next to the nodata value, towards the middle of the range."""
    low, high = header.sample_range
    if dtype.kind == "f":
        return np.nextafter(dtype.type(header.nodata), dtype.type((low + high) / 2))
    return dtype.type(header.nodata + (1 if header.nodata < (low + high) / 2 else -1))
