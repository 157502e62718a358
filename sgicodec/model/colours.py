"""The colours of a model: luma and two differences in place of red, green and blue (docs/format.md, "Channels")."""

from __future__ import annotations

import numpy as np

from sgicodec.arrays import F64
from sgicodec.model.spec import ModelSpec

_LUMA = np.array([0.25, 0.625, 0.125])
"""Of red, green and blue (docs/notes/2026-11-luma-space.md)."""
_DIFFERENCES = 0.65, 0.5
"""How much the two colour differences count in luma space, of what they count in red, green and blue
(docs/notes/2026-11-luma-space.md)."""
_ENDS = np.array([1.0, 0.0, 1.0])


def to_channels(spec: ModelSpec) -> F64:
    """The matrix [C, C] that takes samples to the channels of a model: the first three turn into luma and two
    differences, others stay.

    Squared errors stay what they are; in luma space they become nearer to what is seen.
    """
    matrix = np.eye(spec.channels)
    if spec.channels < 3 or not spec.plain:
        return matrix
    luma, first, second = (_LUMA, *_DIFFERENCES) if spec.luma_space else (np.full(3, 1 / 3), 1.0, 1.0)
    difference = np.array([1.0, 0.0, -1.0])
    matrix[:3, :3] = 3**0.5 * luma, first * 0.5**0.5 * difference, second * 1.5**0.5 * (2 * luma - _ENDS)
    return matrix


def to_samples(spec: ModelSpec) -> F64:
    """The inverse of `to_channels`."""
    return np.asarray(np.linalg.inv(to_channels(spec)), np.float64)
