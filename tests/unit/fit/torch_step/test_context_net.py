"""What MLP_p sees while it trains (floats) against what it sees while it codes (integers), on the same values."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.attributes import quantise_attributes, write_attributes
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import HashGrid
from sgicodec.model.layout import adaptive_layout, uniform_layout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, default_plan
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec
from tests.support.torch_step.context_net import ContextNet
from tests.support.torch_step.quantization_proxy import QuantizationProxy, Sample

SIZE = (160, 120)
QUALITY, FAMILY = 62, 1

SPECS = {
    "default": default_spec(3, prior=0),
    "gray": default_spec(1, prior=0),
    "four channels": default_spec(4, prior=0),
    "paper": paper_spec(3, per_seed=2, features=6),
}
every_spec = pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)


class Fit:
    """A layout, random values of a plausible size, and networks of random weights."""

    def __init__(self, spec: ModelSpec) -> None:
        width, height = SIZE
        rng = np.random.default_rng(1)
        detail = (rng.normal(size=(3, height, width)) * np.linspace(0, 1, width) ** 2).astype(np.float32)
        if spec.layout == "adaptive":
            self.layout = adaptive_layout(detail, 6.0)
        else:
            self.layout = uniform_layout(width, height, 500, rng)
        sizes = {"colour": 0.2, "shape": 0.6, "offset": 0.4, "feature": 2.0, "scales": 2.0}
        self.values = {g.name: rng.normal(size=(len(self.layout), g.size)) * sizes[g.name] for g in spec.groups}
        self.hash_sizes: tuple[int, ...] = ()
        if spec.context.hash_resolutions:
            self.hash_sizes = HashGrid.at(spec.context, self.layout, width, height).sizes
        self.weights = ContextWeights(spec, self.hash_sizes, np.random.default_rng(0))
        self.spec = spec

    def code(self, networks: tuple[Any, ...], plan: StepPlan) -> tuple[dict[str, torch.Tensor], SymbolWriter]:
        """The values as they are decoded, and the walk that wrote them."""
        walk = SymbolWriter()
        plain = replace(self.spec, luma_space=False)
        header = Header(*SIZE, "multi", "uint8", (0.0, 255.0), "default", plain, QUALITY, FAMILY)
        known = self.layout, plan, networks, self.weights.signs() if self.hash_sizes else []
        quantised = quantise_attributes(header, *known, self.values)
        write_attributes(walk, quantised)
        decoded = torch.from_numpy(quantised.values)
        return {group.name: decoded[:, group.columns].float() for group in self.spec.groups}, walk

    def sample(self, net: ContextNet, plan: StepPlan, values: dict[str, torch.Tensor]) -> Sample:
        """The values rounded, and their bits."""
        proxy = QuantizationProxy(self.spec, FAMILY)
        proxy.set_layout(self.layout, QUALITY, *SIZE)
        steps = torch.from_numpy(flat_steps(self.spec, plan))
        return proxy.sample(values, net, steps, "round", NoiseKey(0, False))


@every_spec
def test_the_fit_counts_the_bits_that_are_written(spec: ModelSpec) -> None:
    """With steps that follow the amplitude and real predictions; the escape and the tables' rounding make up 1 %."""
    fit = Fit(spec)
    plan = default_plan(spec, QUALITY)
    networks: tuple[IntNetwork, ...] = fit.weights.integers(8)
    fit.weights.load(networks)
    decoded, walk = fit.code(networks, plan)
    sample = fit.sample(ContextNet(fit.weights), plan, decoded)
    written = sum(walk.bits[group.name] for group in spec.groups)
    assert float(sample.bits.detach().sum()) == pytest.approx(written, rel=0.02)
