"""A fit in its middle: a layout, a picture, values of a plausible size, a network of random weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import ONE_THREAD
from sgicodec.fit.parameters import Parameters
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import network_shapes, output_count
from sgicodec.model.layout import SeedLayout, adaptive_layout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan


def random_networks(
    spec: ModelSpec, rng: np.random.Generator, w2_size: float = 0.3, b2_size: float = 0.2
) -> tuple[IntNetwork, ...]:
    """Networks of weights of a plausible size, in the place of the shipped ones."""
    networks, unit = [], 2.0**8
    for step, stage in enumerate(spec.context.steps):
        w1, b1, w2, b2 = network_shapes(spec, step).values()
        sizes = {"w1": (w1, (2.0 / w1[1]) ** 0.5), "w2": (w2, w2_size / w2[1] ** 0.5), "b2": (b2, b2_size)}
        drawn = {name: np.rint(rng.normal(size=shape) * size * unit) for name, (shape, size) in sizes.items()}
        arrays = {name: values.astype(np.int64) for name, values in drawn.items()}
        predicted = sum(output_count(spec, group) for group in stage)
        networks.append(IntNetwork(b1=np.zeros(b1, np.int64), shift=8, predicted=predicted, **arrays))
    return tuple(networks)


def random_fit(
    spec: ModelSpec, width: int, height: int, quality: int, longest: float
) -> tuple[SeedLayout, NDArray[np.float32], Parameters, tuple[IntNetwork, ...]]:
    """`longest`: |(b, c)| of shapes at most."""
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
    parameters = Parameters(seeds, flat_steps(spec, default_plan(spec, quality)), None)
    return layout, target, parameters, random_networks(spec, rng)
