"""Luma space: a linear mix of red, green and blue in which squared error is nearer to what is seen (docs/format.md)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import from_luma_space
from sgicodec.model.gaussians import colour_matrix

__all__ = ["from_luma_space", "to_luma_space"]

F64 = NDArray[np.float64]

LUMA = np.array([0.25, 0.625, 0.125])
"""Of red, green and blue (docs/notes/2026-11-luma-space.md)."""
DIFFERENCES = np.array([0.65, 0.5])
"""How much the two colour differences count, of what they count in red, green and blue
(docs/notes/2026-11-luma-space.md)."""


def to_luma_space(channels: int) -> F64:
    """The matrix [C, C] that takes samples of red, green, blue and any others to luma space.

    Greys stay what they are. The opponent colours of what comes out are luma in place of the mean, and two differences
    that count less.
    """
    matrix, opponent = np.eye(channels), np.array(colour_matrix(3))
    ends = np.array([1.0, 0.0, 1.0])
    wanted = [3**0.5 * LUMA, 0.5**0.5 * np.array([1.0, 0.0, -1.0]), 1.5**0.5 * (2 * LUMA - ends)]
    matrix[:3, :3] = opponent.T @ (np.array([1.0, *DIFFERENCES])[:, None] * wanted)
    return matrix
