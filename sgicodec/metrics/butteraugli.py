"""Butteraugli of decoded pictures against one original, its map, and its gradient: what an encoder follows.

Native code that agrees with `butteraugli_main`, which `metrics/perceptual.py` asks for reports.

Source: libjxl 0.7, lib/jxl/butteraugli/butteraugli.cc.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.device import ALL_CORES, Device
from sgicodec.metrics.native_reference import NativeReference

__all__ = ["ButteraugliReference"]

F32 = NDArray[np.float32]


class ButteraugliReference(NativeReference[_native.ButteraugliReference]):
    """An original [C, H, W], sRGB samples in 0..1, that decoded pictures of this shape are compared with.

    With one channel or two the first is gray; channels behind the third count nothing. Samples outside 0..1 are
    clipped; white has 80 nits. Holds 65 bytes per pixel, and takes 115 more during a call. Results are the same for any
    number of threads; between instruction sets they differ by rounding.
    """

    def __init__(self, original: F32, device: Device = ALL_CORES) -> None:
        """Raises UsageError unless `original` has three dimensions and samples."""
        super().__init__(_native.ButteraugliReference, original, device)

    def distance(self, decoded: F32) -> tuple[float, F32]:
        """The 3-norm that `butteraugli_main` prints, and how much each pixel [H, W] differs: 0 for equal pictures but
        for 1e-6, and where a side is under 8 pixels.

        The 3-norm is the mean of the 3-, 6- and 12-norm of the map. Raises UsageError for a picture of another shape.
        """
        plain, seen = self._checked(decoded), self._map()
        return self._native.distance(plain, seen), seen

    def gradient(self, decoded: F32) -> tuple[float, F32, F32]:
        """The 3-norm, the map [H, W], and the derivative of the 3-norm in each sample [C, H, W], per full range.

        0 for samples outside 0..1. Raises UsageError for a picture of another shape.
        """
        plain, seen, gradient = self._checked(decoded), self._map(), np.empty(self._shape, np.float32)
        return self._native.gradient(plain, seen, gradient), seen, gradient

    def _map(self) -> F32:
        return np.empty(self._shape[1:], np.float32)
