"""Two pictures that differ by noise and brightness."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def noisy_pair(height: int, width: int, channels: int = 3, seed: int = 0) -> tuple[npt.NDArray, npt.NDArray]:
    """A picture of smooth waves [height, width, channels], and the same darker and with noise."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    base = 128 + 70 * np.sin(x / 7)[..., None] * np.cos(y / 5)[..., None] * np.linspace(0.5, 1, channels)
    a = np.clip(base, 0, 255).astype(np.uint8)
    b = np.clip(base * 0.9 + rng.normal(0, 12, base.shape), 0, 255).astype(np.uint8)
    return a, b
