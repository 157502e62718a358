"""The range of float samples, found part by part."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError
from sgicodec.metadata.layouts import alpha_index
from sgicodec.picture import equal_samples

__all__ = ["Extremes"]


class Extremes:
    """The lowest and the highest colour sample of the pixels added so far, nodata left out."""

    def __init__(self, channels: str, nodata: float | None) -> None:
        self._alpha = alpha_index(channels)
        self._nodata = nodata
        self._low, self._high = np.inf, -np.inf

    def add(self, pixels: npt.NDArray[Any]) -> None:
        """Look at pixels [H, W, C]. Raises PictureError for samples that are infinite or not a number."""
        colours = pixels[..., : self._alpha]
        if self._nodata is not None:
            colours = colours[~equal_samples(colours, self._nodata)]
        if colours.size == 0:
            return
        low, high = float(colours.min()), float(colours.max())
        if np.isnan(low):
            raise PictureError("it holds samples that are not a number; replace them by numbers first")
        if not (np.isfinite(low) and np.isfinite(high)):
            raise PictureError("it holds infinite samples; state a sample range to clip them to")
        self._low, self._high = min(self._low, low), max(self._high, high)

    def range(self) -> tuple[float, float]:
        """What stands for 0 and 1: the extremes, pulled apart if they are equal; 0 and 1 if nothing was measured.

        Raises PictureError for extremes too far apart.
        """
        if self._low > self._high:
            return 0.0, 1.0
        if self._high - self._low > float(np.finfo(np.float32).max):
            raise PictureError(
                f"its samples run from {self._low:g} to {self._high:g}, farther apart than floats of 32 bits tell; "
                "state a sample range to clip them to"
            )
        return self._low, self._high if self._high > self._low else self._low + max(1.0, abs(self._low))
