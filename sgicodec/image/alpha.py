"""Associated (premultiplied) and unassociated alpha.

Where alpha is 0 the colour stays as it is, both ways, so that nothing divides by 0 and no colour is
forgotten.
"""

from __future__ import annotations

import numpy as np

from sgicodec.arrays import Samples


def unassociate(pixels: Samples) -> Samples:
    """Divide the colours of [H, W, C] by the last channel.

    Integers are rounded to nearest and clipped to their type; multiplying again gives back every colour that
    was not larger than its alpha.
    """
    result = pixels.copy()
    if pixels.dtype.kind == "f":
        alpha = pixels[..., -1:]
        np.divide(pixels[..., :-1], alpha, out=result[..., :-1], where=alpha != 0)
        return result
    for row, divided in zip(pixels, result, strict=True):  # row by row, as 64 bits for all would take much memory
        _divide(row, divided)
    return result


def is_clipped(pixels: Samples) -> bool:
    """Whether `unassociate` clips a colour, which cannot be had again."""
    alpha = pixels[..., -1:]
    return pixels.dtype.kind != "f" and bool(((pixels[..., :-1] > alpha) & (alpha != 0)).any())


def _divide(pixels: Samples, result: Samples) -> None:
    """Put the divided colours of integers [W, C] into `result`."""
    alpha, largest = pixels[..., -1:], np.iinfo(pixels.dtype).max
    divisor = np.maximum(alpha, 1).astype(np.uint64)
    colour = (pixels[..., :-1].astype(np.uint64) * largest + divisor // 2) // divisor
    np.copyto(result[..., :-1], np.minimum(colour, largest).astype(pixels.dtype), where=alpha != 0)


def associate(pixels: Samples) -> Samples:
    """Multiply the float colours of [H, W, C] by the last channel."""
    alpha = pixels[..., -1:]
    result = pixels.copy()
    np.multiply(pixels[..., :-1], alpha, out=result[..., :-1], where=alpha != 0)
    return result
