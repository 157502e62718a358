"""LPIPS and DISTS: distances between what two networks see that were trained to recognise things, by torchmetrics."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt


def learned_distance(name: str, a: npt.NDArray[np.uint8], b: npt.NDArray[np.uint8]) -> float:
    """The distance of two pictures [H, W, 3] in 8-bit sRGB: 0 for equal ones.

    `lpips` is version 0.1 with AlexNet (Zhang et al. 2018), `dists` that with VGG-16 (Ding et al. 2020) at the size
    that the pictures have. `network(name)` must not be None.
    """
    import torch

    planes = (np.ascontiguousarray(np.moveaxis(pixels, 2, 0)[None], np.float32) / 255 for pixels in (a, b))
    with torch.inference_mode():
        return float(network(name)(*map(torch.from_numpy, planes)))  # [1, 3, H, W], 0 to 1


@cache
def network(name: str) -> Any:
    """What takes two tensors of planes to `lpips` or `dists`; None without its packages, or without the weights that
    torchvision keeps once they were downloaded: no measurement downloads.
    """
    if not all(map(find_spec, ("torchmetrics", "torchvision"))):
        return None
    import torch
    from torchvision import models

    weights = {"lpips": models.AlexNet_Weights, "dists": models.VGG16_Weights}[name].DEFAULT
    if not Path(torch.hub.get_dir(), "checkpoints", Path(weights.url).name).is_file():
        return None
    if name == "dists":
        from torchmetrics.functional.image.dists import DISTSNetwork

        return DISTSNetwork()  # the metric of the package loads it anew for each pair
    from torchmetrics.image.lpip import LearnedPerceptualImagePatchSimilarity

    return LearnedPerceptualImagePatchSimilarity(net_type="alex", normalize=True)
