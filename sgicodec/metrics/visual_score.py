"""SSIMULACRA 2 of decoded pictures against one original, and its gradient: what an encoder follows.

Native code that agrees with the package ssimulacra2, which `metrics/perceptual.py` asks for reports.

Source: Sneyers 2022, SSIMULACRA 2.1 (constants and weights); the package ssimulacra2 0.3 (borders of the blur: zeros to
the sides, mirrored rows above and below).
"""

from __future__ import annotations

import numpy as np

from sgicodec import _native
from sgicodec.arrays import F32, Rgb8
from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import UsageError


def visual_score(original: Rgb8, decoded: Rgb8, device: Device = ALL_CORES) -> float:
    """SSIMULACRA 2 of a decoded picture, what a screen shows of it; `perceptual.ssimulacra2` without the package.

    Raises UsageError for pictures of different shapes.
    """
    return VisualReference(_samples(original), device).score(_samples(decoded))


class VisualReference:
    """An original [C, H, W], sRGB samples in 0..1, that decoded pictures of this shape are compared with.

    With one channel or two the first is gray; channels behind the third count nothing. Samples outside 0..1 are
    clipped. Holds 40 bytes per pixel, and takes 20 more during a call. Results are the same for any number of threads;
    between instruction sets they differ by rounding.
    """

    def __init__(self, original: F32, device: Device = ALL_CORES) -> None:
        """Raises UsageError unless `original` has three dimensions and samples."""
        if original.ndim != 3 or original.size == 0:
            raise UsageError(f"a picture must be a filled array [C, H, W], not of shape {original.shape}")
        self._shape = original.shape
        self._native = _native.VisualReference(_plain(original), device.threads, device.isa)

    def score(self, decoded: F32) -> float:
        """SSIMULACRA 2: 100 for equal pictures, and where a side is under 8 pixels; no lower end.

        Raises UsageError for a picture of another shape.
        """
        return self._native.score(self._checked(decoded))

    def gradient(self, decoded: F32) -> tuple[float, F32]:
        """The score, and its derivative in each sample [C, H, W], in points per full range of a sample.

        0 for samples outside 0..1. Where the derivative has a step (edges that change sign, samples at 0 and 1), one of
        its sides. Raises UsageError for a picture of another shape.
        """
        gradient = np.empty(self._shape, np.float32)
        return self._native.gradient(self._checked(decoded), gradient), gradient

    def _checked(self, decoded: F32) -> F32:
        if decoded.shape != self._shape:
            raise UsageError(f"a decoded picture of shape {decoded.shape} does not fit the original's {self._shape}")
        return _plain(decoded)


def _plain(picture: F32) -> F32:
    return np.ascontiguousarray(picture, np.float32)


def _samples(pixels: Rgb8) -> F32:
    """8-bit [H, W, C] as [C, H, W] in 0..1."""
    return pixels.transpose(2, 0, 1).astype(np.float32, order="C") / np.float32(255)
