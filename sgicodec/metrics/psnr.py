"""PSNR of two pictures over all samples or over luma, and their largest difference.

All functions take two arrays [H, W, C] of one shape and one type: uint8 (peak 255), uint16 (peak 65535) or floating
point (peak 1 unless stated otherwise). Luma is on the scale 0..255.

Source: ITU-R BT.601 (luma weights).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import UsageError

Pixels = npt.NDArray[Any]  # [H, W, C]
Plane = npt.NDArray[np.float64]  # [H, W]

_LUMA_WEIGHTS = (0.299, 0.587, 0.114)
_BAND = 128
"""Rows handled at a time: float64 copies of a whole satellite picture fit in no cache, and hardly in memory."""


def psnr(a: Pixels, b: Pixels, *, peak: float | None = None) -> float:
    """Peak signal-to-noise ratio over all samples of all channels, in dB; infinite where a equals b.

    `peak` overrides the peak that follows from the type. Raises UsageError if shapes or types differ.
    """
    check_pair(a, b)
    total = sum(_squared_error(a[rows], b[rows]) for rows in bands(a.shape[0]))
    return _decibels(total / a.size, peak_of(a) if peak is None else peak)


def luma(pixels: Pixels, *, peak: float | None = None) -> Plane:
    """BT.601 luma [H, W] on the scale 0..255, unrounded.

    Three channels or more: 0.299 R + 0.587 G + 0.114 B of the first three. One or two (gray, gray and alpha):
    the first.
    """
    scale = 255.0 / (peak_of(pixels) if peak is None else peak)
    if pixels.shape[2] < 3:
        return np.asarray(pixels[..., 0] * np.float64(scale))
    plane = np.zeros(pixels.shape[:2])
    for channel, weight in enumerate(_LUMA_WEIGHTS):
        plane += pixels[..., channel] * np.float64(weight * scale)
    return plane


def plane_psnr(a: Plane, b: Plane) -> float:
    """PSNR in dB of two luma planes [H, W] on the scale 0..255."""
    return psnr(a[..., None], b[..., None], peak=255.0)


def largest_difference(a: Pixels, b: Pixels) -> float:
    """The largest absolute difference of any sample, in the pictures' own units; of those that are not a number in one
    picture infinite, in both none.
    """
    check_pair(a, b)
    return max(_largest(a[rows], b[rows]) for rows in bands(a.shape[0]))


def _largest(a: Pixels, b: Pixels) -> float:
    with np.errstate(invalid="ignore"):
        apart = np.abs(difference(a, b))
    if apart.dtype.kind == "f":
        same = (a == b) | (np.isnan(a) & np.isnan(b))
        apart = np.where(np.isnan(apart), np.where(same, 0, np.inf), apart)
    return float(apart.max())


def check_pair(a: Pixels, b: Pixels) -> None:
    """Raise UsageError unless two pictures have one shape and one type."""
    for pixels in (a, b):
        if pixels.ndim != 3 or pixels.size == 0:
            raise UsageError(f"pixels must be a filled array [H, W, C], not of shape {pixels.shape}")
    if a.shape != b.shape:
        shapes = " and ".join(f"{p.shape[1]}x{p.shape[0]} with {p.shape[2]} channels" for p in (a, b))
        what = "channels" if a.shape[:2] == b.shape[:2] else "size"
        raise UsageError(f"pictures differ in {what}: {shapes}; only equal shapes can be compared")
    if a.dtype != b.dtype:
        raise UsageError(f"pictures differ in depth: {a.dtype} and {b.dtype}; convert one of them first")


def peak_of(pixels: Pixels) -> float:
    """The largest value of a type: 1 for floating point. Raises UsageError for a type that no picture has."""
    if pixels.dtype in (np.uint8, np.uint16):
        return float(np.iinfo(pixels.dtype).max)
    if np.issubdtype(pixels.dtype, np.floating):
        return 1.0
    raise UsageError(f"samples must be uint8, uint16 or floating point, not {pixels.dtype}")


def bands(height: int) -> Iterator[slice]:
    """Slices of rows that cover a height, a few at a time."""
    return (slice(top, min(top + _BAND, height)) for top in range(0, height, _BAND))


def difference(a: Pixels, b: Pixels) -> npt.NDArray[Any]:
    """a − b in a type that holds it: int64 or float64."""
    wide = np.int64 if a.dtype.kind == "u" else np.float64
    return a.astype(wide) - b.astype(wide)


def _squared_error(a: Pixels, b: Pixels) -> float:
    error = difference(a, b).ravel()
    return float(np.dot(error, error))


def _decibels(mean_squared_error: float, peak: float) -> float:
    if mean_squared_error == 0.0:
        return math.inf
    return 10.0 * math.log10(peak * peak / mean_squared_error)
