"""A fit in its middle: a layout, a picture, values of a plausible size, a network of random weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import ONE_THREAD
from sgicodec.fit.context_weights import ContextWeights, layer_shapes, shaped
from sgicodec.fit.parameters import Parameters
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.layout import SeedLayout, adaptive_layout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan

__all__ = ["random_fit"]


def random_fit(
    spec: ModelSpec, width: int, height: int, quality: int, longest: float, frozen: bool = False
) -> tuple[SeedLayout, NDArray[np.float32], Parameters]:
    """`longest`: |(b, c)| of shapes at most. `frozen`: the network is integers, and a difference trains."""
    rng = np.random.default_rng(3)
    detail = (rng.normal(size=(3, height, width)) * np.linspace(0, 1, width) ** 2).astype(np.float32)
    layout = adaptive_layout(detail, 6.0)
    target = rng.normal(size=(spec.channels, height, width)).astype(np.float32) * 0.2
    seeds = SeedSet(spec, layout, target, rng, ONE_THREAD)
    sizes = {"colour": 0.2, "shape": 0.6, "offset": 0.4}
    for name, value in seeds.values.items():
        value[:] = rng.normal(size=value.shape) * sizes[name]
    seeds.values["shape"][:, 0::3] -= 0.7
    seeds.values["shape"][: len(layout) // 8, 1:3] *= 0.01  # nearly round, where differences cancel
    lean = seeds.values["shape"].reshape(-1, 3)[:, 1:]
    lean *= np.minimum(1, longest / np.linalg.norm(lean, axis=1, keepdims=True))
    context = ContextWeights(spec, (), rng)
    context.rest *= 3.0  # W2; both biases are zero
    for b2 in shaped([shape for stage in layer_shapes(spec) for shape in stage[1:]], context.rest)[2::3]:
        b2 += rng.normal(size=b2.shape).astype(np.float32) * 0.2
    if frozen:
        context.adapt(context.integers())
        context.trained()["context.difference"][:] = rng.normal(size=context.rest.shape) * 0.05
    return layout, target, Parameters(seeds, flat_steps(spec, default_plan(spec, quality)), context)
