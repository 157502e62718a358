"""How far two pictures are apart: PSNR, luma PSNR, SSIM and MS-SSIM, and a picture of the error.

All functions take two arrays [H, W, C] of one shape and one type: uint8 (peak 255), uint16 (peak 65535) or
floating point (peak 1 unless told otherwise). Structural similarity and luma PSNR are measured on luma scaled
to 0..255, the scale for which the constants of Wang et al. were chosen.

Sources: ITU-R BT.601 (luma weights); Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error
visibility to structural similarity", 2004; Wang, Simoncelli, Bovik, "Multiscale structural similarity", 2003.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import UsageError

__all__ = [
    "Scores",
    "error_map",
    "largest_difference",
    "luma",
    "luma_psnr",
    "ms_ssim",
    "psnr",
    "scores",
    "ssim",
]

Pixels = npt.NDArray[Any]  # [H, W, C]
Plane = npt.NDArray[np.float64]  # [H, W]

_WINDOW = 11
_SIGMA = 1.5
_C1 = (0.01 * 255.0) ** 2
_C2 = (0.03 * 255.0) ** 2
_SCALE_WEIGHTS = (0.0448, 0.2856, 0.3001, 0.2363, 0.1333)
_LUMA_WEIGHTS = (0.299, 0.587, 0.114)
# Rows handled at a time: float64 copies of a whole satellite picture fit in no cache, and hardly in memory.
_BAND = 128


@dataclass(frozen=True)
class Scores:
    """The figures of one comparison: PSNR in dB (infinite for equal pictures), similarities up to 1."""

    psnr: float
    luma_psnr: float
    ssim: float
    ms_ssim: float


def psnr(a: Pixels, b: Pixels, *, peak: float | None = None) -> float:
    """Peak signal-to-noise ratio over all samples of all channels, in dB; infinite where a equals b.

    `peak` overrides the peak that follows from the type. Raises UsageError if shapes or types differ.
    """
    _check_pair(a, b)
    total = sum(_squared_error(a[rows], b[rows]) for rows in _bands(a.shape[0]))
    return _decibels(total / a.size, _peak(a) if peak is None else peak)


def luma(pixels: Pixels, *, peak: float | None = None) -> Plane:
    """BT.601 luma [H, W] on the scale 0..255, unrounded.

    Three channels or more: 0.299 R + 0.587 G + 0.114 B of the first three. One or two (gray, gray and alpha):
    the first.
    """
    scale = 255.0 / (_peak(pixels) if peak is None else peak)
    if pixels.shape[2] < 3:
        return np.asarray(pixels[..., 0] * np.float64(scale))
    plane = np.zeros(pixels.shape[:2])
    for channel, weight in enumerate(_LUMA_WEIGHTS):
        plane += pixels[..., channel] * np.float64(weight * scale)
    return plane


def luma_psnr(a: Pixels, b: Pixels, *, peak: float | None = None) -> float:
    """PSNR of luma in dB. Raises UsageError if shapes or types differ."""
    _check_pair(a, b)
    return _plane_psnr(luma(a, peak=peak), luma(b, peak=peak))


def ssim(a: Pixels, b: Pixels, *, peak: float | None = None) -> float:
    """Mean structural similarity of luma: Gaussian window of 11 pixels, σ = 1.5, wholly inside the picture.

    A side shorter than 11 pixels shortens the window to it. Raises UsageError if shapes or types differ.
    """
    _check_pair(a, b)
    return _similarity(luma(a, peak=peak), luma(b, peak=peak))[0]


def ms_ssim(a: Pixels, b: Pixels, *, peak: float | None = None) -> float:
    """Multi-scale structural similarity of luma over five halvings, with the weights of Wang et al. 2003.

    The shorter side must be at least 11·2^(S−1) pixels for S scales (176 for five). A smaller picture is
    measured on the finest scales that fit, at least one, with their weights scaled to sum to 1. A negative
    contrast term counts as 0. Raises UsageError if shapes or types differ.
    """
    _check_pair(a, b)
    return _combine(_scale_terms(luma(a, peak=peak), luma(b, peak=peak)))


def scores(a: Pixels, b: Pixels, *, peak: float | None = None) -> Scores:
    """All four figures, sharing the work between them. Raises UsageError if shapes or types differ."""
    rgb = psnr(a, b, peak=peak)
    luma_a, luma_b = luma(a, peak=peak), luma(b, peak=peak)
    terms = _scale_terms(luma_a, luma_b)
    return Scores(rgb, _plane_psnr(luma_a, luma_b), terms[0][0], _combine(terms))


def largest_difference(a: Pixels, b: Pixels) -> float:
    """The largest absolute difference of any sample, in the pictures' own units."""
    _check_pair(a, b)
    return max(float(np.abs(_difference(a[rows], b[rows])).max()) for rows in _bands(a.shape[0]))


def error_map(a: Pixels, b: Pixels, *, gain: float = 8.0, peak: float | None = None) -> npt.NDArray[np.uint8]:
    """The signed error b − a as an 8-bit picture [H, W, C]: mid-gray where equal, `gain` per level.

    Levels are 1/255 of the peak. Raises UsageError if shapes or types differ or `gain` is not positive.
    """
    _check_pair(a, b)
    if not gain > 0:
        raise UsageError(f"the gain of an error map must be positive, not {gain:g}")
    scale = gain * 255.0 / (_peak(a) if peak is None else peak)
    out = np.empty(a.shape, np.uint8)
    for rows in _bands(a.shape[0]):
        out[rows] = np.clip(np.rint(128.0 - _difference(a[rows], b[rows]) * scale), 0, 255)
    return out


def _check_pair(a: Pixels, b: Pixels) -> None:
    for pixels in (a, b):
        if pixels.ndim != 3 or pixels.size == 0:
            raise UsageError(f"pixels must be a filled array [H, W, C], not of shape {pixels.shape}")
    if a.shape != b.shape:
        shapes = " and ".join(f"{p.shape[1]}x{p.shape[0]} with {p.shape[2]} channels" for p in (a, b))
        raise UsageError(f"pictures differ in size: {shapes}; only equal shapes can be compared")
    if a.dtype != b.dtype:
        raise UsageError(f"pictures differ in depth: {a.dtype} and {b.dtype}; convert one of them first")


def _peak(pixels: Pixels) -> float:
    if pixels.dtype in (np.uint8, np.uint16):
        return float(np.iinfo(pixels.dtype).max)
    if np.issubdtype(pixels.dtype, np.floating):
        return 1.0
    raise UsageError(f"samples must be uint8, uint16 or floating point, not {pixels.dtype}")


def _bands(height: int) -> Iterator[slice]:
    return (slice(top, min(top + _BAND, height)) for top in range(0, height, _BAND))


def _difference(a: Pixels, b: Pixels) -> npt.NDArray[Any]:
    wide = np.int64 if a.dtype.kind == "u" else np.float64
    return a.astype(wide) - b.astype(wide)


def _squared_error(a: Pixels, b: Pixels) -> float:
    difference = _difference(a, b).ravel()
    return float(np.dot(difference, difference))


def _plane_psnr(a: Plane, b: Plane) -> float:
    return psnr(a[..., None], b[..., None], peak=255.0)


def _decibels(mean_squared_error: float, peak: float) -> float:
    if mean_squared_error == 0.0:
        return math.inf
    return 10.0 * math.log10(peak * peak / mean_squared_error)


def _gaussian(length: int) -> Plane:
    x = np.arange(length) - (length - 1) / 2
    weights = np.exp(-(x**2) / (2 * _SIGMA**2))
    normalised: Plane = weights / weights.sum()
    return normalised


def _blur(plane: Plane, down: Plane, across: Plane) -> Plane:
    """Separable correlation, only where the window lies inside the plane."""
    rows = plane.shape[0] - len(down) + 1
    cols = plane.shape[1] - len(across) + 1
    tall = sum((w * plane[i : i + rows] for i, w in enumerate(down)), np.zeros((rows, plane.shape[1])))
    return sum((w * tall[:, j : j + cols] for j, w in enumerate(across)), np.zeros((rows, cols)))


def _similarity(a: Plane, b: Plane) -> tuple[float, float]:
    """Mean SSIM and mean of its contrast-structure term."""
    down, across = (_gaussian(min(_WINDOW, side)) for side in a.shape)
    rows, cols = a.shape[0] - len(down) + 1, a.shape[1] - len(across) + 1
    total = np.zeros(2)
    for band in _bands(rows):
        x, y = (plane[band.start : band.stop + len(down) - 1] for plane in (a, b))
        mean_x, mean_y = _blur(x, down, across), _blur(y, down, across)
        spread = _blur(x * x + y * y, down, across) - mean_x**2 - mean_y**2
        shared = _blur(x * y, down, across) - mean_x * mean_y
        contrast = (2 * shared + _C2) / (spread + _C2)
        luminance = (2 * mean_x * mean_y + _C1) / (mean_x**2 + mean_y**2 + _C1)
        total += (luminance * contrast).sum(), contrast.sum()
    similarity, contrast_mean = total / (rows * cols)
    return float(similarity), float(contrast_mean)


def _halve(plane: Plane) -> Plane:
    """Means of 2×2 pixels; an odd last row or column is repeated, as the authors' imfilter does."""
    if plane.shape[0] % 2 or plane.shape[1] % 2:
        plane = np.pad(plane, [(0, side % 2) for side in plane.shape], mode="edge")
    halved: Plane = (plane[::2, ::2] + plane[1::2, ::2] + plane[::2, 1::2] + plane[1::2, 1::2]) / 4
    return halved


def _scale_terms(a: Plane, b: Plane) -> list[tuple[float, float]]:
    """(SSIM, contrast term) of each scale, finest first; as many scales as the shorter side allows."""
    count = 1
    while count < len(_SCALE_WEIGHTS) and min(a.shape) >= _WINDOW * 2**count:
        count += 1
    terms = [_similarity(a, b)]
    for _ in range(count - 1):
        a, b = _halve(a), _halve(b)
        terms.append(_similarity(a, b))
    return terms


def _combine(terms: list[tuple[float, float]]) -> float:
    weights = np.array(_SCALE_WEIGHTS[: len(terms)])
    weights /= weights.sum()
    # Luminance enters at the coarsest scale only.
    values = [contrast for _, contrast in terms[:-1]] + [terms[-1][0]]
    return float(np.prod(np.maximum(values, 0.0) ** weights))
