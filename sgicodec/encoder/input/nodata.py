"""Pixels without content: which they are, a smooth continuation of the others in their place, and how a decoder stores
them: nothing that looks like nodata beside them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32, Mask
from sgicodec.bitstream.header import Header, Masked
from sgicodec.metadata.layouts import band_ranges
from sgicodec.picture import (
    Picture,
    equal_samples,
    exact_samples,
    nodata_mask,
    nodata_samples,
    opaque_mask,
    to_unit,
)


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


def with_least_masks(header: Header, picture: Picture) -> Header:
    """The header of the only tile, which says of masks no more than it needs. A number that is nodata stays, even where
    no sample has it: none may become it.
    """
    if header.masked == "nodata":
        nodata = nodata_samples(picture)
        masked, differ = nodata.any() or not isnan(header.nodata), bool((nodata != nodata[..., :1]).any())
    else:
        masked, differ = empty_pixels(picture, header.masked).any(), False
    return replace(header, masked=header.masked if masked else None, has_band_masks=differ)


OPAQUE = 1.05
"""Alpha that a model is to show where it is opaque: decoders clip it, so that small errors leave it so. With 1.02 to
1.1, sizes differ by 1 %."""


def coded_samples(picture: Picture, header: Header, bare: Bare) -> tuple[F32, Mask | None]:
    """Samples [C, H, W] in 0..1, opaque alpha a little above, and which pixels [H, W] need not be coded, None for none;
    they continue the others. So do single samples that no model shows.
    """
    samples = to_unit(picture)
    if picture.alpha is not None:
        samples[opaque_mask(picture), picture.alpha] = OPAQUE
    unit = np.ascontiguousarray(samples.transpose(2, 0, 1))
    if header.masked == "transparent":
        empty = empty_pixels(picture, header.masked)
        return (inpaint(unit, empty), empty) if empty.any() else (unit, None)
    either = bare.either
    if either is None:
        return unit, None
    empty = np.asarray(either.all(axis=-1))
    if empty.all() and bare.exact is not None:
        return np.zeros_like(unit), None  # a model must carry what is stated
    for band in range(either.shape[2]):
        if (either[..., band] != empty).any():
            unit[band] = inpaint(unit[band : band + 1], either[..., band])[0]
    return (inpaint(unit, empty), empty) if empty.any() else (unit, None)


def store_nodata(header: Header, colours: NDArray[Any], empty: NDArray[np.bool_]) -> None:
    """Stores nodata in the empty samples [h, w, C] of colours; others that have its value go one step aside."""
    alike = ~empty & equal_samples(colours, header.nodata)
    for band, (low, high) in enumerate(band_ranges(header.sample_range, header.colours)):
        colours[alike[..., band], band] = _next_sample(header, colours.dtype, low, high)
    colours[empty] = header.nodata


def _next_sample(header: Header, dtype: np.dtype[Any], low: float, high: float) -> Any:
    """The sample next to the nodata value, towards the middle of the range."""
    if dtype.kind == "f":
        return np.nextafter(dtype.type(header.nodata), dtype.type((low + high) / 2))
    return dtype.type(header.nodata + (1 if header.nodata < (low + high) / 2 else -1))


def inpaint(image: F32, empty: Mask) -> F32:
    """image [C, H, W] with the pixels of `empty` [H, W] continued from the others (push and pull, Gortler 1996).

    Without any other pixel it is zero.
    """
    weight = (~empty).astype(np.float32)
    return _filled(np.where(empty, np.float32(0), image), weight)


def _filled(image: F32, weight: F32) -> F32:
    """`image`, already multiplied by `weight`, where that is 1; continued where it is less."""
    if min(weight.shape) == 1 and max(weight.shape) == 1:
        return image
    if weight.min() >= 1:
        return image
    coarse_weight = _halved(weight[None])[0]
    scale = np.where(coarse_weight > 0, np.minimum(coarse_weight, 1) / np.maximum(coarse_weight, 1e-9), 0)
    coarse = _filled(_halved(image) * scale.astype(np.float32), np.minimum(coarse_weight, 1))
    rows, columns = weight.shape
    smooth = _doubled(_doubled(coarse, 1)[:, :rows], 2)[:, :, :columns]
    return np.asarray(image + (1 - weight) * smooth, np.float32)


def _halved(image: F32) -> F32:
    """Sums of 2×2 pixels [C, ⌈H/2⌉, ⌈W/2⌉]."""
    _, rows, columns = image.shape
    even = np.pad(image, ((0, 0), (0, rows % 2), (0, columns % 2)))
    return np.asarray(even[:, ::2, ::2] + even[:, 1::2, ::2] + even[:, ::2, 1::2] + even[:, 1::2, 1::2], np.float32)


def _doubled(image: F32, axis: int) -> F32:
    """Twice as long along an axis, linearly interpolated between the old centres."""
    old = np.moveaxis(image, axis, 0)
    padded = np.concatenate([old[:1], old, old[-1:]])
    new = np.empty((2 * len(old), *old.shape[1:]), np.float32)
    new[::2] = 0.75 * old + 0.25 * padded[:-2]
    new[1::2] = 0.75 * old + 0.25 * padded[2:]
    return np.moveaxis(new, 0, axis)
