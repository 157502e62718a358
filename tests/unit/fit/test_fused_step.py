"""The native step against the sampler, the Gaussians and autograd in torch, on every instruction set."""

import itertools

import numpy as np
import pytest
import torch
from torch import Tensor

from sgicodec import _native
from sgicodec.device import Device
from sgicodec.fit.context_training import ContextNet
from sgicodec.fit.fused_step import NoiseKey, SeedStep
from sgicodec.fit.quantization_noise import Sampler
from sgicodec.fit.raster_op import squared_error
from sgicodec.fit.rate import bits_laplace
from sgicodec.fit.settings import Rounding
from sgicodec.model.gaussians import colour_matrix, gaussians_from_seeds
from sgicodec.model.layout import adaptive_layout
from sgicodec.model.spec import ModelSpec, default_spec, paper_spec
from sgicodec.model.steps import default_plan
from sgicodec.raster.cpu import NativeRasterizer

WIDTH, HEIGHT = 160, 120
QUALITY, FAMILY, LMBDA, KEY = 62, 1, 0.004, 12345
NOISE = NoiseKey(KEY, False)

SPECS = {
    "default": default_spec(3, prior=0),
    "K = 2": default_spec(3, per_seed=2, prior=0),
    "gray": default_spec(1, prior=0),
    "gray and alpha": default_spec(2, prior=0),
    "four channels": default_spec(4, prior=0),
}


def available_isas() -> list[str]:
    found = []
    for isa in ("portable", "avx2", "avx512"):
        try:
            _native.Rasterizer(isa, 1, 1)
        except ValueError:
            continue
        found.append(isa)
    return found


def expected_noise(column: int, seeds: int) -> np.ndarray:
    """lowbias32 over seed, column and key, in 64-bit arithmetic."""
    mask = 0xFFFFFFFF
    x = (np.arange(seeds, dtype=np.uint64) * 0x9E3779B9) & mask
    x ^= np.uint64((KEY + column * 0x85EBCA6B) & mask)
    x = ((x ^ (x >> np.uint64(16))) * np.uint64(0x7FEB352D)) & mask
    x = ((x ^ (x >> np.uint64(15))) * np.uint64(0x846CA68B)) & mask
    x ^= x >> np.uint64(16)
    return ((x >> np.uint64(8)).astype(np.float64) + 0.5) / 2**24 - 0.5


class KnownNoise(Sampler):
    """Draws the noise that the native step hashes, and remembers the means, steps and scales of each group."""

    column: int
    sign = 1
    predicted: list[tuple[Tensor, Tensor, Tensor]]

    def _perturb(  # type: ignore[override]
        self, value: Tensor, m: Tensor, q: Tensor, s: Tensor, rounding: Rounding, generator: torch.Generator
    ) -> Tensor:
        if rounding != "noise":
            return super()._perturb(value, m, q, s, rounding, generator)
        self.predicted.append((m.detach(), q.detach(), s.detach()))
        start = self.column
        self.column += value.shape[1]
        columns = [self.sign * expected_noise(start + j, len(value)) for j in range(value.shape[1])]
        return value + q * torch.from_numpy(np.stack(columns, axis=1)).float()


class Problem:
    """A layout, a picture, values of a plausible size, a network of random weights that trains."""

    def __init__(self, spec: ModelSpec, frozen: bool = False) -> None:
        rng = np.random.default_rng(3)
        detail = (rng.normal(size=(3, HEIGHT, WIDTH)) * np.linspace(0, 1, WIDTH) ** 2).astype(np.float32)
        self.spec, self.layout = spec, adaptive_layout(detail, 6.0)
        self.target = rng.normal(size=(spec.channels, HEIGHT, WIDTH)).astype(np.float32) * 0.2
        sizes = {"colour": 0.2, "shape": 0.6, "offset": 0.4}
        self.values = {
            g.name: torch.from_numpy(rng.normal(size=(len(self.layout), g.size)) * sizes[g.name]).float()
            for g in spec.groups
        }
        self.values["shape"][:, 0::3] -= 0.7
        self.values["shape"][: len(self.layout) // 8, 1:3] *= 0.01  # nearly round, where differences cancel
        self.net = ContextNet(spec, (), torch.Generator().manual_seed(0))
        with torch.no_grad():
            for layer in self.net.layers:
                layer[2] *= 3.0
                layer[3] += torch.from_numpy(rng.normal(size=layer[3].shape) * 0.2).float()
        if frozen:
            for tensor in self.net.parameters():
                tensor.requires_grad_(False)
            with torch.no_grad():
                self.net.adapt().normal_(0, 0.05, generator=torch.Generator().manual_seed(1))
        self.sampler = KnownNoise(spec, self.net, default_plan(spec, QUALITY), FAMILY)
        self.sampler.set_layout(self.layout, QUALITY, WIDTH, HEIGHT)

    def leaves(self) -> dict[str, Tensor]:
        trained = [t for t in self.net.parameters() if t.requires_grad]
        if self.net.difference is not None:
            trained = [self.net.difference]
        return {**self.values, "steps": self.sampler.steps, **{f"net {i}": t for i, t in enumerate(trained)}}

    def fresh(self) -> None:
        for tensor in self.leaves().values():
            tensor.grad = None
            tensor.requires_grad_()

    def torch_step(
        self, rounding: Rounding, level: int, isa: str = "auto"
    ) -> tuple[float, float, dict[str, Tensor | None]]:
        self.fresh()
        self.sampler.column, self.sampler.age, self.sampler.predicted = 0, 0, []
        attributes = torch.cat([self.values[g.name] for g in self.spec.groups], dim=1)
        bits = torch.zeros(1)
        if rounding != "none":
            sample = self.sampler.sample(self.values, rounding, torch.Generator())
            attributes, bits = sample.attributes, sample.bits
        scale = 0.5**level
        gaussians = gaussians_from_seeds(
            self.spec,
            attributes,
            torch.from_numpy(self.layout.centre) * scale,
            torch.from_numpy(self.layout.cell) * scale,
            {},
            torch.tensor(colour_matrix(self.spec.channels)),
            torch,
        )
        error = squared_error(*gaussians, torch.from_numpy(self.reduced(level)), NativeRasterizer(Device(1, isa)))
        side = self.net.difference_bits() if rounding != "none" else torch.zeros(())
        (error + LMBDA * (bits.sum() + side)).backward()  # type: ignore[no-untyped-call]
        return float(error.detach()), float(bits.detach().sum()), {name: t.grad for name, t in self.leaves().items()}

    def native(self, isa: str = "auto", threads: int = 1) -> SeedStep:
        step = SeedStep(self.spec, NativeRasterizer(Device(threads, isa)), threads)
        step.set_layout(self.layout, QUALITY)
        return step

    def native_step(
        self,
        rounding: Rounding,
        level: int,
        isa: str,
        threads: int = 1,
        step: SeedStep | None = None,
        noise: NoiseKey = NOISE,
    ) -> tuple[float, float, dict[str, Tensor | None]]:
        self.fresh()
        step = step or self.native(isa, threads)
        lmbda = LMBDA if rounding != "none" else 0.0
        target = self.reduced(level)
        error, bits = step.run(self.values, self.net, self.sampler.steps, rounding, noise, target, 0.5**level, lmbda)
        return error, bits, {name: t.grad for name, t in self.leaves().items()}

    def reduced(self, level: int) -> np.ndarray:
        return np.ascontiguousarray(self.target[:, :: 2**level, :: 2**level])


def assert_close(found: dict[str, Tensor | None], expected: dict[str, Tensor | None]) -> None:
    """Within what the rasteriser's cutoff makes of the last bit of a coordinate: a pixel more or less."""
    for name, want in expected.items():
        got = found[name]
        if want is None or not want.abs().max():
            assert got is None or not got.abs().max(), name
            continue
        assert got is not None, name
        scale = want.abs().max()
        assert float((got - want).abs().max() / scale) < 3e-3, name
        assert float((got - want).norm() / want.norm()) < 1e-3, name


@pytest.mark.parametrize("isa", available_isas())
@pytest.mark.parametrize("rounding", ["none", "noise", "round"])
@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_native_step_is_the_sampler_and_autograd(spec: ModelSpec, rounding: Rounding, isa: str) -> None:
    problem = Problem(spec)
    error, bits, expected = problem.torch_step(rounding, 0, isa)
    found_error, found_bits, found = problem.native_step(rounding, 0, isa)
    assert (found_error, found_bits) == pytest.approx((error, bits), rel=2e-5)
    assert_close(found, expected)


@pytest.mark.parametrize("rounding", ["none", "noise"])
def test_native_step_on_a_smaller_picture(rounding: Rounding) -> None:
    problem = Problem(default_spec(3, prior=0))
    error, bits, expected = problem.torch_step(rounding, 1)
    found_error, found_bits, found = problem.native_step(rounding, 1, "auto")
    assert (found_error, found_bits) == pytest.approx((error, bits), rel=2e-5)
    assert_close(found, expected)


def test_native_step_with_differences_to_fixed_networks() -> None:
    problem = Problem(default_spec(3, prior=0), frozen=True)
    error, bits, expected = problem.torch_step("noise", 0)
    found_error, found_bits, found = problem.native_step("noise", 0, "auto")
    assert (found_error, found_bits) == pytest.approx((error, bits), rel=2e-5)
    assert_close(found, expected)


@pytest.mark.parametrize("isa", available_isas())
def test_between_its_runs_the_network_said_constants(isa: str) -> None:
    problem = Problem(default_spec(3, prior=0), frozen=True)
    problem.torch_step("noise", 0, isa)
    predicted = [tensors for tensors in problem.sampler.predicted]
    step = problem.native(isa)
    _, _, whole = problem.native_step("noise", 0, isa, step=step)
    for value in problem.values.values():
        value.data += 0.1
    _, bits, found = problem.native_step("noise", 0, isa, step=step)

    costs = torch.zeros(())
    drawn, column = [], 0
    for (m, q, s), value in zip(predicted, problem.values.values(), strict=True):
        noise = np.stack([expected_noise(column + j, len(value)) for j in range(value.shape[1])], axis=1)
        column += value.shape[1]
        drawn.append(value + q * torch.from_numpy(noise).float())
        costs = costs + bits_laplace(drawn[-1] - m, q.expand_as(drawn[-1]), s.expand_as(drawn[-1])).sum()
    centre, cell = torch.from_numpy(problem.layout.centre), torch.from_numpy(problem.layout.cell)
    opponent = torch.tensor(colour_matrix(3))
    gaussians = gaussians_from_seeds(problem.spec, torch.cat(drawn, dim=1), centre, cell, {}, opponent, torch)
    error = squared_error(*gaussians, torch.from_numpy(problem.target), NativeRasterizer(Device(1, isa)))
    for value in problem.values.values():
        value.grad = None
    (error + LMBDA * costs).backward()  # type: ignore[no-untyped-call]
    assert bits == pytest.approx(float(costs.detach()), rel=2e-5)
    standing = {name: grad for name, grad in whole.items() if name not in problem.values}
    assert_close(found, {**{name: value.grad for name, value in problem.values.items()}, **standing})


def test_when_the_network_runs() -> None:
    problem = Problem(default_spec(3, prior=0), frozen=True)
    step, runs = problem.native(), []
    for _ in range(9):
        before = problem.native_step("noise", 0, "auto", step=step)[1]
        with torch.no_grad():
            problem.net.difference += 0.01  # type: ignore[operator]
        problem.sampler.steps.data += 0.01
        runs.append(before)
    same = [a == b for a, b in itertools.pairwise(runs)]
    assert same == [True, True, True, False, True, True, True, False]
    step = problem.native()
    rounded = [problem.native_step("round", 0, "auto", step=step)[1]]
    problem.sampler.steps.data += 0.01
    assert problem.native_step("round", 0, "auto", step=step)[1] != rounded[0]


@pytest.mark.parametrize("isa", available_isas())
def test_noise_with_its_signs_turned(isa: str) -> None:
    problem = Problem(default_spec(3, prior=0))
    problem.sampler.sign = -1
    error, bits, expected = problem.torch_step("noise", 0, isa)
    found_error, found_bits, found = problem.native_step("noise", 0, isa, noise=NoiseKey(KEY, True))
    assert (found_error, found_bits) == pytest.approx((error, bits), rel=2e-5)
    assert_close(found, expected)


def test_threads_change_no_bit() -> None:
    problem = Problem(default_spec(3, prior=0))
    one = problem.native_step("noise", 0, "auto", threads=1)
    four = problem.native_step("noise", 0, "auto", threads=4)
    assert one[:2] == four[:2]
    for name, grad in one[2].items():
        assert grad is not None
        assert torch.equal(grad, four[2][name])  # type: ignore[arg-type]


def test_the_paper_profile_has_no_native_step() -> None:
    assert SeedStep.can_run(SPECS["default"])
    assert not SeedStep.can_run(paper_spec(3))
    assert not SeedStep.can_run(default_spec(3, hidden=16))
