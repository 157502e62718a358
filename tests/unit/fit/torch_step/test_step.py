"""A step of the paper's model: its loss against the method's formulas, in float64 and one after the other."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from sgicodec.device import ONE_THREAD
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.noise import NoiseKey, hashed_noise
from sgicodec.fit.parameters import Parameters
from sgicodec.fit.pyramid import Level
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import HashGrid
from sgicodec.model.gaussians import MIN_VARIANCE, decoder_parts
from sgicodec.model.layout import uniform_layout
from sgicodec.model.steps import default_plan
from sgicodec.profiles.paper import paper_settings, paper_spec
from sgicodec.raster.cpu import NativeRasterizer
from tests.support.torch_step.step import AutogradStep

WIDTH, HEIGHT, SEEDS, K, D, LMBDA = 36, 28, 9, 3, 5, 0.05
SPEC = replace(paper_spec(3, per_seed=K, features=D))
SETTINGS = replace(paper_settings(LMBDA, 3, 500), rate_sample=1.0)


def step_and_parameters() -> tuple[AutogradStep, Parameters]:
    """A model in the middle of a fit."""
    rng = np.random.default_rng(4)
    layout = uniform_layout(WIDTH, HEIGHT, SEEDS, rng)
    target = rng.random((3, HEIGHT, WIDTH)).astype(np.float32)
    seeds = SeedSet(SPEC, layout, target, rng, ONE_THREAD)
    seeds.values["feature"] += rng.normal(0, 1.5, (SEEDS, D)).astype(np.float32)
    seeds.values["scales"] += rng.normal(0, 0.2, (SEEDS, 4)).astype(np.float32)
    for weights in seeds.decoders.values():
        weights += rng.normal(0, 0.1, weights.shape).astype(np.float32)
    sizes = HashGrid.at(SPEC.context, layout, WIDTH, HEIGHT).sizes
    context = ContextWeights(SPEC, sizes, rng)
    context.centre(seeds.attributes())
    step = AutogradStep(SPEC, SETTINGS, NativeRasterizer(ONE_THREAD, cutoff=7.0), 0, (WIDTH, HEIGHT))
    step.set_layout(layout, 60)
    return step, Parameters(seeds, flat_steps(SPEC, default_plan(SPEC, 60)), context)


def level(scale: float = 1.0) -> Level:
    rng = np.random.default_rng(8)
    return Level(rng.random((3, int(HEIGHT * scale), int(WIDTH * scale))).astype(np.float32), scale)


def mean_absolute_error(leaves: dict[str, torch.Tensor], parameters: Parameters, aim: Level) -> torch.Tensor:
    """Equations 1 to 5 and L1, a Gaussian at a time."""
    target = torch.from_numpy(aim.samples).double()
    y, x = torch.meshgrid(*(torch.arange(n) + 0.5 for n in target.shape[1:]), indexing="ij")
    image = torch.zeros_like(target)
    decoders = decoder_parts(SPEC, torch.cat([leaves["decoder_colour"], leaves["decoder_shape"]]))
    for seed, centre in enumerate(torch.from_numpy(parameters.seeds.layout.centre).double()):
        said = {}
        for net in ("colour", "shape"):
            w1, b1, w2, b2 = (decoders[f"{net}.{name}"] for name in ("w1", "b1", "w2", "b2"))
            said[net] = (w2 @ torch.relu(w1 @ leaves["feature"][seed] + b1) + b2).reshape(K, 3)
        offsets, scales = leaves["offset"][seed].reshape(K, 2), torch.exp(leaves["scales"][seed])
        for k in range(K):
            mx, my = aim.scale * (centre + offsets[k] * scales[:2])
            s1, s2 = (aim.scale * scales[2 + i] * torch.sigmoid(said["shape"][k, i]) for i in (0, 1))
            cos, sin = torch.cos(said["shape"][k, 2]), torch.sin(said["shape"][k, 2])
            xx = (cos * s1) ** 2 + (sin * s2) ** 2 + MIN_VARIANCE
            yy = (sin * s1) ** 2 + (cos * s2) ** 2 + MIN_VARIANCE
            xy = cos * sin * (s1**2 - s2**2)
            dx, dy = x - mx, y - my
            distance = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)
            image = image + said["colour"][k][:, None, None] * torch.exp(-0.5 * distance)
    return (image - target).abs().mean()


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_gradients_of_the_distortion(scale: float) -> None:
    step, parameters = step_and_parameters()
    found = step.run(parameters, "none", 0, level(scale), 0.0).gradients
    leaves = {name: torch.from_numpy(a).double().requires_grad_() for name, a in parameters.trained().items()}
    mean_absolute_error(leaves, parameters, level(scale)).backward()
    expected = {name: leaf.grad.numpy() for name, leaf in leaves.items() if leaf.grad is not None}
    assert set(found) == set(expected) == {"feature", "scales", "offset", *(n for n in leaves if "decoder" in n)}
    for name, gradient in expected.items():
        np.testing.assert_allclose(found[name], gradient, atol=1e-4 * np.abs(gradient).max(), err_msg=name)
        assert np.abs(gradient).max() > 0


def test_the_price_of_bits_is_that_of_equation_11() -> None:
    """λ / (N d_A) for each bit of the grid and of the seeds."""
    step, parameters = step_and_parameters()
    parameters.context.first[:] = 0.0  # so that attributes say nothing of the grid
    gradient = step.run(parameters, "noise", 0, level(), LMBDA).gradients["context.tables"]
    found, signs = parameters.context.per_table(gradient)[0], parameters.context.signs()[0]
    share = signs.mean()
    slope = 0.5 * math.log2((1 - share) / share)  # of L_hash in one entry's sign, equation 12
    np.testing.assert_allclose(found, LMBDA / (SEEDS * SPEC.attributes) * slope, rtol=1e-4)


def test_bits_are_those_of_the_gaussian_that_mlp_p_predicts() -> None:
    """Equation 10 in plain numbers for seed 0, with W1 of MLP_p at zero: biases alone predict."""
    step, parameters = step_and_parameters()
    parameters.context.first[:] = 0.0
    total = step.run(parameters, "noise", 0, level(), LMBDA)
    d = SPEC.attributes
    mean, scale, refine = np.split(parameters.context.rest[-2 * d - 3 :], [d, 2 * d])
    bits, start = 0.0, 0
    coded = parameters.seeds.coded()
    for position, (name, base) in enumerate((("feature", 1.0), ("scales", 1.0), ("offset", 2 ** (-14 / 6)))):
        q = base * 2 ** refine[position]
        for j in range(coded[name].shape[1]):
            drawn = coded[name][0, j] + q * hashed_noise(NoiseKey.of(SETTINGS.seed, 0), start + j, SEEDS)[0]
            m, s = mean[start + j] * base, base * 2 ** scale[start + j]
            low, high = (0.5 * (1 + math.erf((drawn + side * q - m) / s / 2**0.5)) for side in (-0.5, 0.5))
            bits -= math.log2(max(high - low, 2.0**-20))
        start += coded[name].shape[1]
    assert step.seed_bits()[0] == pytest.approx(bits, rel=5e-4)  # what float32 leaves of the tails
    assert total.bits > step.seed_bits()[0]
