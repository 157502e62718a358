"""The samples of a picture as a model is to show them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.encoder.inpainting import inpaint
from sgicodec.encoder.nodata import Bare, empty_pixels
from sgicodec.picture import Picture, opaque_mask, to_unit

__all__ = ["coded_samples"]

_BEYOND_OPAQUE = 0.05
"""Decoders clip alpha, so that errors up to this leave opaque what is; with 0.02 to 0.1, sizes differ by 1 %."""


def coded_samples(picture: Picture, header: Header, bare: Bare) -> tuple[NDArray[np.float32], NDArray[np.bool_] | None]:
    """Samples [C, H, W] in 0..1, opaque alpha a little above, and which pixels [H, W] need not be coded, None for none;
    they continue the others. So do single samples that no model shows.
    """
    samples = to_unit(picture)
    if picture.alpha is not None:
        samples[opaque_mask(picture), picture.alpha] = 1.0 + _BEYOND_OPAQUE
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
