"""All distortions by name: what settings choose from."""

from __future__ import annotations

from sgicodec.metrics.distortion import F32, Distortion, Mask, QuadraticReference
from sgicodec.metrics.weighted_squared_error import WeightedSquaredError

__all__ = ["DISTORTIONS"]


class SquaredError:
    """Σ e², what PSNR measures: every sample of every pixel counts the same."""

    name = "squared"

    def reference(self, picture: F32, empty: Mask | None = None) -> QuadraticReference:
        """See `Distortion.reference`."""
        return QuadraticReference()


_ALL: tuple[Distortion, ...] = (SquaredError(), WeightedSquaredError())

DISTORTIONS: dict[str, Distortion] = {distortion.name: distortion for distortion in _ALL}
