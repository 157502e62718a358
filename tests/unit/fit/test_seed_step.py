"""The native step against the same model under automatic differentiation, on every instruction set."""

import math
from typing import Any

import numpy as np
import pytest
import torch
from random_fit import random_fit
from scenes import ISAS
from torch import Tensor

from sgicodec._native import DEAD_ZONE, DEAD_ZONE_LIMIT
from sgicodec.device import Device
from sgicodec.fit.noise import NoiseKey, hashed_noise
from sgicodec.fit.parameters import StepResult
from sgicodec.fit.pyramid import PyramidLevel
from sgicodec.fit.seed_step import SeedStep
from sgicodec.model.gaussians import gaussians_from_seeds
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.fit_settings import FitSettings, Phase, Rounding
from sgicodec.raster.cpu import NativeRasterizer
from tests.support.torch_step.quantization_proxy import QuantizationProxy, bits_laplace
from tests.support.torch_step.step import AutogradStep, error

WIDTH, HEIGHT = 160, 120
QUALITY, FAMILY, LMBDA, SEED = 62, 1, 0.004, 12345
LONGEST = 1.25
"""|(b, c)| at most."""
TOLERANCE = 32 * 2.0**-24 * math.exp(4 * LONGEST)
"""Of gradients. What float32 loses in Σ is a part of its larger variance, and Σ⁻¹ divides by the smaller one: their
ratio is e^(4 |(b, c)|). Each of two implementations is off by a few half units of the last place; the determinant
doubles that, and so does Σ⁻¹ on both sides of the second moments. An axis of 149 pixels across one of 0.9 has the ratio
26,000: there gradients are good to one part in twenty.
"""

SPECS = {
    "default": default_spec(3),
    "gray": default_spec(1),
    "gray and alpha": default_spec(2),
    "four channels": default_spec(4),
}


class Recorded(QuantizationProxy):
    """Remembers the means, steps and scales of each group."""

    predicted: list[tuple[Tensor, Tensor, Tensor]]

    def _perturb(self, value: Tensor, m: Tensor, q: Tensor, s: Tensor, noise: Tensor | None) -> Tensor:
        self.predicted.append((m.detach(), q.detach(), s.detach()))
        return super()._perturb(value, m, q, s, noise)


class Problem:
    """A layout, a picture, values of a plausible size, networks of random weights."""

    def __init__(self, spec: ModelSpec) -> None:
        self.spec, fit = spec, random_fit(spec, WIDTH, HEIGHT, QUALITY, LONGEST)
        self.layout, self.target, self.parameters, self.networks = fit
        settings = FitSettings(LMBDA, (Phase(1),), seed=SEED)
        raster = NativeRasterizer(Device(1))
        self.reference = AutogradStep(spec, settings, raster, FAMILY, (WIDTH, HEIGHT), self.networks)
        self.reference.proxy = self.proxy = Recorded(spec, FAMILY)
        self.reference.set_layout(self.layout, QUALITY)

    @property
    def values(self) -> dict[str, np.ndarray]:
        return self.parameters.seeds.values

    def autograd_step(self, rounding: Rounding, level: int, isa: str = "auto", weighted: bool = False) -> StepResult:
        self.reference.raster = NativeRasterizer(Device(1, isa))
        self.proxy.age, self.proxy.predicted = 0, []
        return self.reference.run(*self.step_at(rounding, level, weighted))

    def decide(self) -> None:
        """Moves what lies so near to the end of a quantisation interval that its side is a matter of the last bits."""
        for _ in range(20):
            self.autograd_step("round", 0)
            open_ = 0
            for value, (m, q, s) in zip(self.values.values(), self.proxy.predicted, strict=True):
                position = np.abs((value - m.numpy()) / q.numpy())
                end = position + 0.5 - np.minimum(DEAD_ZONE * (q / s).numpy(), DEAD_ZONE_LIMIT)
                undecided = np.abs(end - np.rint(end)) < 1e-3
                value += 0.1 * q.numpy() * undecided
                open_ += undecided.sum()
            if not open_:
                return
        raise AssertionError("some decisions stay open")

    def fused(self, isa: str = "auto", threads: int = 1) -> SeedStep:
        device = Device(threads, isa)
        step = SeedStep(self.spec, SEED, self.networks, NativeRasterizer(device), device)
        step.set_layout(self.layout, QUALITY)
        return step

    def native_step(self, rounding: Rounding, level: int, isa: str = "auto", weighted: bool = False) -> StepResult:
        return self.fused(isa).run(*self.step_at(rounding, level, weighted))

    def step_at(self, rounding: Rounding, level: int, weighted: bool = False) -> tuple[Any, ...]:
        """What a step is given."""
        samples = np.ascontiguousarray(self.target[:, :: 2**level, :: 2**level])
        weights = np.random.default_rng(9).uniform(0.2, 3.0, samples.shape[1:]).astype(np.float32)
        at = PyramidLevel(samples, 0.5**level, weights if weighted else None)
        return self.parameters, rounding, 0, at, LMBDA if rounding != "none" else 0.0


def assert_close(found: StepResult, expected: StepResult) -> None:
    assert (found.error, found.bits) == pytest.approx((expected.error, expected.bits), rel=2e-6)
    assert found.gradients.keys() == expected.gradients.keys()
    for name, want in expected.gradients.items():
        got, scale = found.gradients[name], np.abs(want).max()
        assert scale > 0, name
        assert float(np.abs(got - want).max() / scale) < TOLERANCE, name
        assert float(np.linalg.norm(got - want) / np.linalg.norm(want)) < TOLERANCE, name


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("rounding", ["none", "noise", "round"])
@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_it_is_the_quantisation_proxy_and_autograd(spec: ModelSpec, rounding: Rounding, isa: str) -> None:
    problem = Problem(spec)
    if rounding == "round":
        problem.decide()
    assert_close(problem.native_step(rounding, 0, isa), problem.autograd_step(rounding, 0, isa))


@pytest.mark.parametrize("rounding", ["none", "noise"])
def test_a_smaller_picture(rounding: Rounding) -> None:
    problem = Problem(default_spec(3))
    assert_close(problem.native_step(rounding, 1), problem.autograd_step(rounding, 1))


@pytest.mark.parametrize("isa", ISAS)
def test_between_its_runs_the_network_said_constants(isa: str) -> None:
    problem = Problem(default_spec(3))
    expected, step, given = problem.autograd_step("noise", 0, isa), problem.fused(isa), problem.step_at("noise", 0)
    whole = step.run(*given)
    assert_close(whole, expected)
    for value in problem.values.values():
        value += 0.1
    found = step.run(*given)

    costs, drawn, column = torch.zeros(()), [], 0
    leaves = {name: torch.from_numpy(value).requires_grad_() for name, value in problem.values.items()}
    for (m, q, s), value in zip(problem.proxy.predicted, leaves.values(), strict=True):
        noise = np.stack(
            [hashed_noise(NoiseKey.of(SEED, 0), column + j, len(value)) for j in range(value.shape[1])], axis=1
        )
        column += value.shape[1]
        drawn.append(value + q * torch.from_numpy(noise).float())
        costs = costs + bits_laplace(drawn[-1] - m, q.expand_as(drawn[-1]), s.expand_as(drawn[-1])).sum()
    centre, cell = torch.from_numpy(problem.layout.centre), torch.from_numpy(problem.layout.cell)
    gaussians = gaussians_from_seeds(problem.spec, torch.cat(drawn, dim=1), centre, cell, {}, torch)
    loss = error(gaussians, torch.from_numpy(given[3].samples), problem.reference.raster)[0]
    (loss + LMBDA * costs).backward()  # type: ignore[no-untyped-call]
    gradients = {name: leaf.grad.numpy() for name, leaf in leaves.items() if leaf.grad is not None}
    steps = {"steps": found.gradients["steps"]}
    assert not np.array_equal(steps["steps"], whole.gradients["steps"])
    assert_close(found, StepResult(found.error, float(costs.detach()), gradients | steps))


def test_threads_change_no_bit() -> None:
    problem = Problem(default_spec(3))
    one, four = (problem.fused(threads=threads).run(*problem.step_at("noise", 0)) for threads in (1, 4))
    assert (one.error, one.bits) == (four.error, four.bits)
    for name, gradient in one.gradients.items():
        np.testing.assert_array_equal(gradient, four.gradients[name])


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("level", [0, 1])
def test_weights_are_those_of_automatic_differentiation(level: int, isa: str) -> None:
    """Gradients are of the weighted error, the error is plain. Without noise, so that both draw the same."""
    problem = Problem(SPECS["default"])
    found, expected = problem.native_step("none", level, isa, True), problem.autograd_step("none", level, isa, True)
    plain = problem.native_step("none", level, isa)
    assert found.error == pytest.approx(expected.error, rel=2e-5)
    assert found.error == pytest.approx(plain.error, rel=1e-6)
    for name in ("colour", "shape", "offset"):
        got, want, unweighted = (step.gradients[name] for step in (found, expected, plain))
        assert float(np.linalg.norm(got - want) / np.linalg.norm(want)) < 1e-3, name
        assert float(np.linalg.norm(got - unweighted) / np.linalg.norm(want)) > 0.1, name
