"""Bits that the torch model of a fit counts, against the tables that code them and the stream that is written."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import torch
from frequency_tables import SCALES, frequency_tables
from numpy.typing import NDArray
from random_fit import random_networks

from sgicodec._native import PER_OCTAVE, SCALE_ZERO
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel, quantise, write_tile
from sgicodec.fit.context_weights import ContextWeights, float_weights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import hash_grid
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import adaptive_layout, uniform_layout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec
from tests.support.torch_step.context_net import ContextNet
from tests.support.torch_step.quantization_proxy import QuantizationProxy, bits_gaussian, bits_laplace

Rate = Callable[[torch.Tensor, torch.Tensor, torch.Tensor], torch.Tensor]

SIZE = (160, 120)
QUALITY, FAMILY = 62, 1
SPREAD = {"colour": 0.2, "shape": 0.6, "offset": 0.4, "feature": 2.0, "scales": 2.0}
"""Of values of a plausible size."""
SPECS = {
    "default": default_spec(3),
    "gray": default_spec(1),
    "four channels": default_spec(4),
    "paper": paper_spec(3, per_seed=2, features=6),
}


@pytest.mark.parametrize(("family", "bits"), [(0, bits_gaussian), (1, bits_laplace)])
@pytest.mark.parametrize("scale", [12, SCALE_ZERO, 40])
def test_the_tables_cost_what_the_fit_believes(family: int, bits: Rate, scale: int) -> None:
    """Symbols that a scale index makes likely: the fit's bits with σ = 2^((index − 24) / 6) steps."""
    sigma = 2.0 ** ((scale - SCALE_ZERO) / PER_OCTAVE)
    symbols = np.arange(-math.ceil(3 * sigma), math.ceil(3 * sigma) + 1)
    coded = frequency_tables().bits(symbols, scale + SCALES * family)
    believed = bits(torch.tensor(symbols, dtype=torch.float64), torch.ones(1).double(), torch.tensor(sigma).double())
    likely = coded < 18
    np.testing.assert_allclose(believed.numpy()[likely], coded[likely], atol=0.02)


def context_of(spec: ModelSpec) -> tuple[tuple[IntNetwork, ...], list[NDArray[np.int64]], ContextNet]:
    """Random networks, signs of a hash grid, and both in floats."""
    rng, counts = np.random.default_rng(0), hash_grid(spec.context, *SIZE).counts
    networks = random_networks(spec, rng, w2_size=0.1, b2_size=0.0)
    if not counts:
        return networks, [], ContextNet(spec, float_weights(networks, 0.0))
    weights = ContextWeights(spec, counts, rng)
    weights.first, weights.rest = float_weights(networks, 0.0)
    return networks, weights.signs(), ContextNet(spec, weights)


@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_the_fit_counts_the_bits_that_are_written(spec: ModelSpec) -> None:
    """Of random values and networks: what MLP_p sees as floats in a fit, and as integers in coding. With steps that
    follow the amplitude and real predictions; the escape and the tables' rounding make up 1 %.
    """
    (width, height), rng = SIZE, np.random.default_rng(1)
    detail = (rng.normal(size=(3, height, width)) * np.linspace(0, 1, width) ** 2).astype(np.float32)
    is_adaptive = spec.layout == "adaptive"
    layout = adaptive_layout(detail, 6.0) if is_adaptive else uniform_layout(width, height, 500, rng)
    values = {g.name: rng.normal(size=(len(layout), g.size)) * SPREAD[g.name] for g in spec.groups}
    spec = replace(spec, luma_space=False, base_cell=0)
    plan, networks, signs, net = default_plan(spec, QUALITY), *context_of(spec)
    header = Header(*SIZE, "multi", "uint8", (0.0, 255.0), "default", spec, QUALITY, FAMILY)
    base, decoders = np.zeros((3, 0, 0), np.int64), {n: np.zeros(s, np.int64) for n, s in decoder_shapes(spec).items()}
    model = TileModel(layout, plan, 0, base, decoders, networks, signs, values, decoder_shift=8)
    quantised, (_, bits) = quantise(header, model), write_tile(header, model)
    written = sum(bits[group.name] for group in spec.groups)

    decoded = torch.from_numpy(quantised.decoded_values)
    rounded = {group.name: decoded[:, group.columns].float() for group in spec.groups}
    proxy = QuantizationProxy(spec, FAMILY)
    proxy.set_layout(layout, QUALITY, *SIZE)
    steps = torch.from_numpy(flat_steps(spec, plan))
    sample = proxy.sample(rounded, net, steps, "round", NoiseKey(0, False))
    assert float(sample.bits.detach().sum()) == pytest.approx(written, rel=0.02)
