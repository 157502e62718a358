"""Bits of quantised values under a zero-centred density, differentiable in values, scales and steps."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from sgicodec._native import MIN_MASS

__all__ = ["bits_gaussian", "bits_laplace"]


def bits_gaussian(deviation: Tensor, step: Tensor, scale: Tensor) -> Tensor:
    """−log2 of the Gaussian's mass in [d − q/2, d + q/2] (paper, equation 10); all tensors alike in shape.

    Written with |d| so that a tail's mass is no difference of numbers near 1.
    """
    size = deviation.abs()
    nearer = torch.special.ndtr((0.5 * step - size) / scale)
    beyond = torch.special.ndtr((-0.5 * step - size) / scale)
    return -torch.log2((nearer - beyond).clamp_min(MIN_MASS))


def bits_laplace(deviation: Tensor, step: Tensor, scale: Tensor) -> Tensor:
    """−log2 of the Laplacian's mass in [d − q/2, d + q/2]; `scale` is its standard deviation.

    Written with |d| so that neither tail cancels.
    """
    rate, size, half = math.sqrt(2.0) / scale, deviation.abs(), 0.5 * step
    inside = half - size
    near = 0.5 * torch.exp(-rate * inside.abs())  # mass between the mean and the nearer edge, from its tail
    far = 0.5 * torch.exp(-rate * (half + size))
    return -torch.log2((torch.where(inside > 0, 1.0 - near, near) - far).clamp_min(MIN_MASS))
