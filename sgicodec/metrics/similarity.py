"""Structural similarity of luma: SSIM and MS-SSIM.

Luma is scaled to 0..255, the scale for which the constants of Wang et al. were chosen.

Sources: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to structural similarity",
2004; Wang, Simoncelli, Bovik, "Multiscale structural similarity", 2003.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import correlate1d

from sgicodec.metrics.psnr import Plane, bands

_WINDOW = 11
_SIGMA = 1.5
_C1 = (0.01 * 255.0) ** 2
_C2 = (0.03 * 255.0) ** 2
_SCALE_WEIGHTS = (0.0448, 0.2856, 0.3001, 0.2363, 0.1333)


def scale_terms(a: Plane, b: Plane) -> list[tuple[float, float]]:
    """(SSIM, contrast term) of two luma planes at each scale, finest first; as many scales as the shorter side allows.

    SSIM is the mean structural similarity: Gaussian window of 11 pixels, σ = 1.5, wholly inside the picture. A side
    shorter than 11 pixels shortens the window to it.
    """
    count = 1
    while count < len(_SCALE_WEIGHTS) and min(a.shape) >= _WINDOW * 2**count:
        count += 1
    terms = [_similarity(a, b)]
    for _ in range(count - 1):
        a, b = _halve(a), _halve(b)
        terms.append(_similarity(a, b))
    return terms


def combine(terms: list[tuple[float, float]]) -> float:
    """MS-SSIM from the terms of all scales: over five halvings, with the weights of Wang et al. 2003.

    The shorter side must be at least 11·2^(S−1) pixels for S scales (176 for five). A smaller picture is measured on
    the finest scales that fit, at least one, with their weights scaled to sum to 1. A negative contrast term counts as
    0.
    """
    weights = np.array(_SCALE_WEIGHTS[: len(terms)])
    weights /= weights.sum()
    # Luminance enters at the coarsest scale only.
    values = [contrast for _, contrast in terms[:-1]] + [terms[-1][0]]
    return float(np.prod(np.maximum(values, 0.0) ** weights))


def _similarity(a: Plane, b: Plane) -> tuple[float, float]:
    """Mean SSIM and mean of its contrast-structure term."""
    down, across = (_gaussian(min(_WINDOW, side)) for side in a.shape)
    rows, cols = a.shape[0] - len(down) + 1, a.shape[1] - len(across) + 1
    total = np.zeros(2)
    for band in bands(rows):
        x, y = (plane[band.start : band.stop + len(down) - 1] for plane in (a, b))
        mean_x, mean_y = _blur(x, down, across), _blur(y, down, across)
        spread = _blur(x * x + y * y, down, across) - mean_x**2 - mean_y**2
        shared = _blur(x * y, down, across) - mean_x * mean_y
        contrast = (2 * shared + _C2) / (spread + _C2)
        luminance = (2 * mean_x * mean_y + _C1) / (mean_x**2 + mean_y**2 + _C1)
        total += (luminance * contrast).sum(), contrast.sum()
    similarity, contrast_mean = total / (rows * cols)
    return float(similarity), float(contrast_mean)


def _gaussian(length: int) -> Plane:
    x = np.arange(length) - (length - 1) / 2
    weights = np.exp(-(x**2) / (2 * _SIGMA**2))
    normalised: Plane = weights / weights.sum()
    return normalised


def _blur(plane: Plane, down: Plane, across: Plane) -> Plane:
    """Separable correlation, only where the window lies inside the plane."""
    blurred = correlate1d(correlate1d(plane, down, axis=0), across, axis=1)
    top, left = (len(down) // 2, len(across) // 2)
    rows, cols = plane.shape[0] - len(down) + 1, plane.shape[1] - len(across) + 1
    inside: Plane = blurred[top : top + rows, left : left + cols]
    return inside


def _halve(plane: Plane) -> Plane:
    """Means of 2×2 pixels; an odd last row or column is repeated, as the authors' imfilter does."""
    if plane.shape[0] % 2 or plane.shape[1] % 2:
        plane = np.pad(plane, [(0, side % 2) for side in plane.shape], mode="edge")
    halved: Plane = (plane[::2, ::2] + plane[1::2, ::2] + plane[::2, 1::2] + plane[1::2, 1::2]) / 4
    return halved
