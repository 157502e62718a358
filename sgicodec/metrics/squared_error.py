"""Plain squared error: every sample of every pixel counts the same."""

from __future__ import annotations

from sgicodec.metrics.distortion import F32, Mask, QuadraticReference

__all__ = ["SquaredError"]


class SquaredError:
    """Σ e², what PSNR measures."""

    name = "squared"

    def reference(self, picture: F32, empty: Mask | None = None) -> QuadraticReference:
        """See `Distortion.reference`."""
        return QuadraticReference()
