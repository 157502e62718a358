"""Pixels without content: which they are; and as a decoder stores them, nothing that looks like nodata beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header, Masked
from sgicodec.metadata.layouts import band_ranges
from sgicodec.picture import Picture, equal_samples, exact_samples, nodata_mask, nodata_samples

__all__ = ["Bare", "bare_samples", "empty_pixels", "store_nodata"]


@dataclass(frozen=True)
class Bare:
    """The colour samples of a picture that no model shows, [H, W, colours] each, None for none: those without content,
    and those that are stated exactly.
    """

    nodata: NDArray[np.bool_] | None
    exact: NDArray[np.bool_] | None

    @property
    def either(self) -> NDArray[np.bool_] | None:
        """Which samples are one or the other."""
        if self.nodata is None or self.exact is None:
            return self.exact if self.nodata is None else self.nodata
        return self.nodata | self.exact


def bare_samples(picture: Picture, header: Header) -> Bare:
    """Those of the picture of a tile."""
    nodata = nodata_samples(picture) if header.masked == "nodata" else None
    exact = exact_samples(picture) if header.has_exact else None
    return Bare(*(None if part is None or not part.any() else part for part in (nodata, exact)))


def empty_pixels(picture: Picture, masked: Masked | None) -> NDArray[np.bool_]:
    """Which pixels [H, W] need not be coded."""
    if masked == "transparent":
        return np.asarray(picture.pixels[..., -1] == 0)
    return nodata_mask(picture)


def store_nodata(header: Header, colours: NDArray[Any], empty: NDArray[np.bool_]) -> None:
    """Stores nodata in the empty samples [h, w, C] of colours; others that have its value go one step aside."""
    alike = ~empty & equal_samples(colours, header.nodata)
    for band, (low, high) in enumerate(band_ranges(header.sample_range, header.colours)):
        colours[alike[..., band], band] = _beside(header, colours.dtype, low, high)
    colours[empty] = header.nodata


def _beside(header: Header, dtype: np.dtype[Any], low: float, high: float) -> Any:
    """The sample next to the nodata value, towards the middle of the range."""
    if dtype.kind == "f":
        return np.nextafter(dtype.type(header.nodata), dtype.type((low + high) / 2))
    return dtype.type(header.nodata + (1 if header.nodata < (low + high) / 2 else -1))
