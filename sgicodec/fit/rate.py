"""Bits of quantised values under a zero-centred density, differentiable in values, scales and steps."""

from __future__ import annotations

import math

import torch
from torch import Tensor

__all__ = ["bits_gaussian", "bits_laplace"]

_FLOOR = 2.0**-20
"""Least probability of a value: what the escape symbol guarantees."""


def bits_gaussian(deviation: Tensor, step: Tensor, scale: Tensor) -> Tensor:
    """−log2 of the Gaussian's mass in [d − q/2, d + q/2] (paper, equation 10); all tensors alike in shape."""
    upper = torch.special.ndtr((deviation + 0.5 * step) / scale)
    lower = torch.special.ndtr((deviation - 0.5 * step) / scale)
    return -torch.log2((upper - lower).clamp_min(_FLOOR))


def bits_laplace(deviation: Tensor, step: Tensor, scale: Tensor) -> Tensor:
    """−log2 of the Laplacian's mass in [d − q/2, d + q/2]; `scale` is its standard deviation.

    Written with |d| so that neither tail cancels.
    """
    rate = math.sqrt(2.0) / scale
    size, half = deviation.abs(), 0.5 * step
    far = 0.5 * torch.exp(-rate * (size - half).clamp_min(0.0))
    inside = torch.exp(-rate * (size + half))
    across = 0.5 * torch.exp(-rate * (half - size).clamp_min(0.0))
    mass = torch.where(size >= half, far - 0.5 * inside, 1.0 - across - 0.5 * inside)
    return -torch.log2(mass.clamp_min(_FLOOR))
