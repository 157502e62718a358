"""The paper profile's step on every instruction set and on a GPU (fake_cuda.cpp) against automatic differentiation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fake_cuda import backwards, fake_gpu, only_gpu
from scenes import ISAS

from sgicodec.device import ONE_THREAD, Device
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.device_feature_step import DeviceFeatureStep
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import pyramid_levels
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.fit.trainer import Trainer
from sgicodec.model.context import hash_grid
from sgicodec.model.layout import uniform_layout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan
from sgicodec.profiles.fit_settings import FitSettings, Rounding
from sgicodec.profiles.paper import paper_settings, paper_spec
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.cuda import CudaRasterizer
from tests.support.torch_step.step import AutogradStep

WIDTH, HEIGHT, QUALITY, LMBDA = 120, 90, 60, 0.02
CUTOFF = 6.0
"""Where what a GPU draws and a processor not is below rounding."""
BACKENDS = [*ISAS, "cuda"]
SPECS = {
    "as published": paper_spec(3),
    "K = 3, D = 7": paper_spec(3, per_seed=3, features=7),
    "gray": paper_spec(1, per_seed=2, features=9),
    "four channels": paper_spec(4, per_seed=2, features=6),
}
SPEC = paper_spec(3, per_seed=3, features=5)
CASES: list[tuple[Rounding, float]] = [("none", 0.0), ("noise", 0.0), ("noise", LMBDA)]


class Problem:
    """A model in the middle of a fit."""

    def __init__(self, spec: ModelSpec, seeds: int = 150, settings: FitSettings | None = None) -> None:
        rng = np.random.default_rng(4)
        self.spec, self.settings = spec, settings or paper_settings(LMBDA, 3, 500)
        self.layout = uniform_layout(WIDTH, HEIGHT, seeds, rng)
        target = rng.random((spec.channels, HEIGHT, WIDTH)).astype(np.float32)
        self.levels = pyramid_levels(target, None, 2)
        held = SeedSet(spec, self.layout, target, rng, ONE_THREAD)
        held.values["feature"] += rng.normal(0, 1.5, (seeds, spec.features)).astype(np.float32)
        held.values["scales"] += rng.normal(-0.5, 0.5, (seeds, 4)).astype(np.float32)
        for weights in held.decoders.values():
            weights += rng.normal(0, 0.1, weights.shape).astype(np.float32)
        context = ContextWeights(spec, hash_grid(spec.context, WIDTH, HEIGHT).counts, rng)
        context.centre(held.attributes())
        context.rest += rng.normal(0, 0.05, context.rest.shape).astype(np.float32)
        of_scales = slice(-spec.attributes - 3, -3)
        context.rest[of_scales] += 1.5  # no value is beyond all odds, where its gradient ends
        context.tables[:] = rng.normal(0, 1, context.tables.shape)  # beyond ±1, too
        self.parameters = Parameters(held, flat_steps(spec, default_plan(spec, QUALITY)), context)

    def step(self, backend: str = "auto", threads: int = 1) -> FeatureStep | DeviceFeatureStep:
        step: FeatureStep | DeviceFeatureStep
        if backend == "cuda":
            step = DeviceFeatureStep(self.spec, self.settings, CudaRasterizer(fake_gpu(), CUTOFF), (WIDTH, HEIGHT))
        else:
            device = Device(threads, backend)
            step = FeatureStep(self.spec, self.settings, NativeRasterizer(device), (WIDTH, HEIGHT), device)
        step.set_layout(self.layout, QUALITY)
        return step

    def autograd(self, backend: str) -> AutogradStep:
        raster = NativeRasterizer(Device(1), CUTOFF) if backend == "cuda" else NativeRasterizer(Device(1, backend))
        step = AutogradStep(self.spec, self.settings, raster, 0, (WIDTH, HEIGHT))
        step.set_layout(self.layout, QUALITY)
        return step


def assert_close(found: StepResult, expected: StepResult) -> None:
    """Equal to what float32 leaves of sums over a few thousand pixels. A gradient of |I − T| jumps where they meet."""
    assert found.error == pytest.approx(expected.error, rel=1e-4)
    assert found.bits == pytest.approx(expected.bits, rel=1e-4)
    trained = {name: gradient for name, gradient in expected.gradients.items() if name != "steps"}
    assert set(found.gradients) == set(trained)
    for name, gradient in trained.items():
        away = np.linalg.norm(found.gradients[name] - gradient) / np.linalg.norm(gradient)
        assert away < 5e-3, name


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(("rounding", "lmbda"), CASES)
@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_against_automatic_differentiation(
    spec: ModelSpec, rounding: Rounding, lmbda: float, level: int, backend: str
) -> None:
    problem = Problem(spec)
    steps = problem.step(backend), problem.autograd(backend)
    found, expected = (step.run(problem.parameters, rounding, 3, problem.levels[level], lmbda) for step in steps)
    assert_close(found, expected)


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_many_seeds_the_bits_of_a_few_count(backend: str) -> None:
    """Where a value lies far out, its own gradient is that of few bits of float32."""
    problem = Problem(SPEC, 2500)
    steps = problem.step(backend), problem.autograd(backend)
    results = [step.run(problem.parameters, "noise", 3, problem.levels[0], LMBDA) for step in steps]
    for result in results:
        for name in ("offset", "context.tables"):
            del result.gradients[name]
    assert_close(*results)


def test_a_fit_is_on_the_gpu_that_was_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """But for five channels, which its kernels do not have."""
    settings, device = paper_settings(LMBDA, 3, 500), only_gpu(monkeypatch)
    for spec, expected in ((SPEC, DeviceFeatureStep), (paper_spec(5), FeatureStep)):
        layout = uniform_layout(9, 9, 4, np.random.default_rng(0))
        trainer = Trainer(spec, settings, np.zeros((spec.channels, 9, 9), np.float32), layout, device=device)
        assert type(trainer.gradient_step) is expected


def equal(found: StepResult, expected: StepResult) -> None:
    assert (found.error, found.bits) == (expected.error, expected.bits)
    for name, gradient in expected.gradients.items():
        np.testing.assert_array_equal(found.gradients[name], gradient)
        assert np.isfinite(gradient).all()


@pytest.mark.parametrize("seeds", [1, 127, 128, 129, 1000])
def test_threads_change_no_bit(seeds: int) -> None:
    problem = Problem(paper_spec(3, per_seed=2, features=4), seeds)
    one, four = (
        problem.step(threads=threads).run(problem.parameters, "noise", 0, problem.levels[0], LMBDA)
        for threads in (1, 4)
    )
    equal(four, one)


def test_phases_and_levels_follow_each_other() -> None:
    """What a step leaves on the GPU changes no later one, whatever had room."""
    problem = Problem(paper_spec(3, per_seed=2, features=9), 300)
    step = problem.step("cuda")
    for rounding, lmbda in (*CASES, *reversed(CASES)):
        for level in problem.levels:
            again = problem.step("cuda").run(problem.parameters, rounding, 5, level, lmbda)
            equal(step.run(problem.parameters, rounding, 5, level, lmbda), again)


def test_the_order_of_threads_on_a_gpu_changes_no_byte() -> None:
    problem = Problem(paper_spec(3, per_seed=2, features=9), 300)
    forwards = problem.step("cuda").run(problem.parameters, "noise", 1, problem.levels[0], LMBDA)
    with backwards():
        equal(problem.step("cuda").run(problem.parameters, "noise", 1, problem.levels[0], LMBDA), forwards)


def test_the_price_of_bits_is_that_of_equation_11() -> None:
    """λ / (N d_A) for each bit of the grid, where attributes say nothing of it and the last biases of MLP_p predict."""
    problem = Problem(SPEC, 9)
    context = problem.parameters.context
    context.first[:] = 0.0
    context.rest[: -2 * SPEC.attributes - 3] = 0.0  # all but the last biases
    found = problem.step().run(problem.parameters, "noise", 0, problem.levels[0], LMBDA)
    gradient, theta = (context.per_table(table)[0] for table in (found.gradients["context.tables"], context.tables))
    share = context.signs()[0].mean()
    slope = 0.5 * math.log2((1 - share) / share)  # of L_hash in one entry's sign, equation 12
    expected = np.where(np.abs(theta) <= 1, LMBDA / (9 * SPEC.attributes) * slope, 0)  # straight through up to 1
    np.testing.assert_allclose(gradient, expected, rtol=1e-4)
