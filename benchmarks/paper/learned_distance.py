"""LPIPS, where its package and the network's weights are installed."""

from __future__ import annotations

import warnings
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from sgicodec.bench.codec import Pixels8

__all__ = ["learned_distance"]


def learned_distance(a: Pixels8, b: Pixels8) -> float | None:
    """LPIPS (Zhang et al. 2018, version 0.1, AlexNet) of two pictures [H, W, 3]: 0 for equal ones, less is better.

    None without the package lpips, or without the weights of AlexNet, which torchvision fetches once. The paper does
    not name its network; AlexNet is the package's default.
    """
    network = _network()
    if network is None:
        return None
    import torch

    planes = (torch.from_numpy(np.ascontiguousarray(pixels.transpose(2, 0, 1)[None])) for pixels in (a, b))
    with torch.no_grad():
        return float(network(*(plane.float() / 127.5 - 1 for plane in planes)))


@cache
def _network() -> Any:
    if find_spec("lpips") is None or find_spec("torchvision") is None:
        return None
    import lpips

    try:
        with warnings.catch_warnings(action="ignore"):
            return lpips.LPIPS(net="alex", verbose=False).eval()
    except OSError:  # no weights, and no way to fetch them
        return None
