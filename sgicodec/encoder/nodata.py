"""Pixels without content: which they are; and as a decoder stores them, nothing that looks like nodata beside them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header, Masked
from sgicodec.picture import Picture, equal_samples, nodata_mask

__all__ = ["empty_pixels", "store_nodata"]


def empty_pixels(picture: Picture, masked: Masked | None) -> NDArray[np.bool_]:
    """Which pixels [H, W] need not be coded."""
    if masked == "transparent":
        return np.asarray(picture.pixels[..., -1] == 0)
    return nodata_mask(picture)


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
