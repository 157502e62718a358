"""What attributes are under noise and rounded, in the paper's model."""

import numpy as np
import pytest
import torch

from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import HashGrid
from sgicodec.model.layout import uniform_layout
from sgicodec.model.steps import default_plan
from sgicodec.profiles.paper import paper_spec
from tools.autograd.context_net import ContextNet
from tools.autograd.quantization_proxy import QuantizationProxy

SPEC, SIZE = paper_spec(3, per_seed=4, features=10), (90, 60)
LAYOUT = uniform_layout(*SIZE, 150, np.random.default_rng(1))
STEPS = torch.from_numpy(flat_steps(SPEC, default_plan(SPEC, 60)))
PUBLISHED = {"feature": 1.0, "scales": 1.0, "offset": 0.2}


def proxy() -> QuantizationProxy:
    made = QuantizationProxy(SPEC, 0)
    made.set_layout(LAYOUT, 60, *SIZE)
    return made


def some_values() -> dict[str, torch.Tensor]:
    rng = np.random.default_rng(2)
    return {g.name: torch.from_numpy(rng.normal(3.0, 2.0, (150, g.size)).astype(np.float32)) for g in SPEC.groups}


@pytest.mark.parametrize("scale", [1.0, 0.5, 0.25])
def test_noise_is_a_step_wide(scale: float) -> None:
    """Of the published steps: in pixels of the full size for scales, and smaller at coarse levels for offsets."""
    values = some_values()
    sample = proxy().noisy(values, STEPS, scale, NoiseKey(3, False))
    assert not sample.bits.any()
    for group in SPEC.groups:
        step = PUBLISHED[group.name] * (scale if group.name == "offset" else 1.0)
        noise = (sample.attributes[:, group.columns] - values[group.name]).numpy()
        assert np.abs(noise).max() == pytest.approx(step / 2, rel=0.03)
        assert noise.std() == pytest.approx(step / 12**0.5, rel=0.05)
        assert abs(noise.mean()) < 0.03 * step


def test_noise_lets_gradients_through() -> None:
    values = {name: value.requires_grad_() for name, value in some_values().items()}
    weights = torch.randn(150, SPEC.attributes, generator=torch.Generator().manual_seed(4))
    (weights * proxy().noisy(values, STEPS, 0.5, NoiseKey(0, False)).attributes).sum().backward()
    for group in SPEC.groups:
        np.testing.assert_array_equal(values[group.name].grad.numpy(), weights[:, group.columns].numpy())


def test_gaussian_attributes_are_rounded_to_the_nearest() -> None:
    """A dead zone would be an error that the fit never saw."""
    sizes = HashGrid.at(SPEC.context, LAYOUT, *SIZE).sizes
    context = ContextWeights(SPEC, sizes, np.random.default_rng(5))
    context.rest[:] = 0.0  # no refinement, and q is Q
    values = some_values()
    rounded = proxy().sample(values, ContextNet(context), STEPS, "round", NoiseKey(0, False)).attributes.detach()
    for group in SPEC.groups:
        error = np.abs((rounded[:, group.columns] - values[group.name]).numpy()) / PUBLISHED[group.name]
        assert 0.49 < error.max() < 0.51
        assert error.mean() == pytest.approx(0.25, abs=0.02)
