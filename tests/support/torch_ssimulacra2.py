"""SSIMULACRA 2 in float64 with torch, which gives its gradient: the reference of native/metrics.

Constants are those of the package ssimulacra2, with which its scores agree.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from ssimulacra2 import ssimulacra2 as package
from torch import Tensor
from torch.nn import functional

F64 = NDArray[np.float64]

_OPSIN = torch.tensor(package.kOpsinAbsorbanceMatrix.reshape(3, 3))
_BIAS = torch.tensor(package.kOpsinAbsorbanceBias)[:, None, None]
_TAPS = torch.exp(-(torch.arange(-5, 6).double() ** 2) / (2 * 1.5**2))


def score(original: F64, decoded: F64) -> float:
    """The score of two pictures [3, H, W], sRGB samples in 0..1."""
    return float(_score(torch.tensor(original), torch.tensor(decoded)))


def gradient(original: F64, decoded: F64) -> F64:
    """The derivative of `score` in the samples of `decoded`."""
    samples = torch.tensor(decoded, requires_grad=True)
    _score(torch.tensor(original), samples).backward()
    assert samples.grad is not None
    return samples.grad.numpy()


def _score(original: Tensor, decoded: Tensor) -> Tensor:
    planes = [_linear(picture) for picture in (original, decoded)]  # [3, H, W]
    norms = []  # of each scale: [3, 2, 3] channels, powers, maps
    while len(norms) < package.kNumScales and min(planes[0].shape[1:]) >= 8:
        norms.append(_norms(*map(_xyb, planes)))
        planes = [functional.avg_pool2d(p, 2, ceil_mode=True, count_include_pad=False) for p in planes]
    if not norms:
        return torch.tensor(100.0)
    weights = torch.tensor(package.weights)[: 18 * len(norms)]
    total = (torch.stack(norms, 1).ravel() * weights).sum() * 0.9562382616834844
    curve = 2.326765642916932 * total - 0.020884521182843837 * total**2 + 6.248496625763138e-05 * total**3
    return 100 - 10 * curve**0.6276336467831387


def _linear(samples: Tensor) -> Tensor:
    clipped = samples.clamp(0, 1)
    return torch.where(clipped <= 0.04045, clipped / 12.92, ((clipped + 0.055) / 1.055) ** 2.4)


def _xyb(linear: Tensor) -> Tensor:
    cones = (torch.einsum("ij,jhw->ihw", _OPSIN, linear) + _BIAS) ** (1 / 3) - _BIAS ** (1 / 3)
    x, y = (cones[0] - cones[1]) / 2, (cones[0] + cones[1]) / 2
    return torch.stack([14 * x + 0.42, y + 0.01, cones[2] - y + 0.55])


def _blur(planes: Tensor) -> Tensor:
    taps = _TAPS / _TAPS.sum()
    mirrored = torch.cat([planes[:, :5].flip(1), planes, planes[:, -5:].flip(1)], 1)
    down = functional.conv2d(mirrored[:, None], taps[None, None, :, None])
    return functional.conv2d(functional.pad(down, (5, 5)), taps[None, None, None, :])[:, 0]


def _norms(a: Tensor, b: Tensor) -> Tensor:
    mean_a, mean_b = _blur(a), _blur(b)
    variances = _blur(a * a) - mean_a**2 + _blur(b * b) - mean_b**2
    covariance = _blur(a * b) - mean_a * mean_b
    similar = (1 - (mean_a - mean_b) ** 2) * (2 * covariance + package.kC2) / (variances + package.kC2)
    change = (1 + (b - mean_b).abs()) / (1 + (a - mean_a).abs()) - 1
    maps = torch.stack([1 - similar, change, -change], 1).clamp(min=0)  # [3, maps, H, W]
    means = maps.mean((2, 3)), (maps**4).mean((2, 3))
    return torch.stack([means[0], (means[1] + 1e-300) ** 0.25], 1)
