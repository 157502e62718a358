"""The paper profile's native step against the same model under automatic differentiation, on every instruction set."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import ISAS

from sgicodec.device import ONE_THREAD, Device
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import Level, levels_of
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import HashGrid
from sgicodec.model.layout import uniform_layout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.fit_settings import FitSettings, Phase, Rounding
from sgicodec.profiles.paper import paper_settings, paper_spec
from sgicodec.raster.cpu import NativeRasterizer
from tools.autograd.step import AutogradStep

WIDTH, HEIGHT, QUALITY, LMBDA = 120, 90, 60, 0.02
SPECS = {
    "as published": paper_spec(3),
    "K = 3, D = 7": paper_spec(3, per_seed=3, features=7),
    "gray": paper_spec(1, per_seed=2, features=9),
    "four channels": paper_spec(4, per_seed=2, features=6),
}
CASES: list[tuple[Rounding, float]] = [("none", 0.0), ("noise", 0.0), ("noise", LMBDA)]


class Problem:
    """A model in the middle of a fit."""

    def __init__(self, spec: ModelSpec, seeds: int = 150, settings: FitSettings | None = None) -> None:
        rng = np.random.default_rng(4)
        self.spec, self.settings = spec, settings or paper_settings(LMBDA, 3, 500)
        self.layout = uniform_layout(WIDTH, HEIGHT, seeds, rng)
        target = rng.random((spec.channels, HEIGHT, WIDTH)).astype(np.float32)
        self.levels = levels_of(target, None, 2)
        held = SeedSet(spec, self.layout, target, rng, ONE_THREAD)
        held.values["feature"] += rng.normal(0, 1.5, (seeds, spec.features)).astype(np.float32)
        held.values["scales"] += rng.normal(-0.5, 0.5, (seeds, 4)).astype(np.float32)
        for weights in held.decoders.values():
            weights += rng.normal(0, 0.1, weights.shape).astype(np.float32)
        context = ContextWeights(spec, HashGrid.at(spec.context, self.layout, WIDTH, HEIGHT).sizes, rng)
        context.centre(held.attributes())
        context.rest += rng.normal(0, 0.05, context.rest.shape).astype(np.float32)
        of_scales = slice(-spec.attributes - 3, -3)
        context.rest[of_scales] += 1.5  # no value is beyond all odds, where its gradient ends
        for table in context.tables:
            table[:] = rng.normal(0, 1, table.shape)  # beyond ±1, too
        self.parameters = Parameters(held, flat_steps(spec, default_plan(spec, QUALITY)), context)

    def native(self, isa: str = "auto", threads: int = 1) -> FeatureStep:
        device = Device(threads, isa)
        step = FeatureStep(self.spec, self.settings, NativeRasterizer(device), (WIDTH, HEIGHT), device)
        step.set_layout(self.layout, QUALITY)
        return step

    def autograd(self, isa: str = "auto") -> AutogradStep:
        raster = NativeRasterizer(Device(1, isa))
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


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(("rounding", "lmbda"), CASES)
@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_against_automatic_differentiation(
    spec: ModelSpec, rounding: Rounding, lmbda: float, level: int, isa: str
) -> None:
    problem = Problem(spec)
    aim = problem.levels[level]
    found = problem.native(isa).run(problem.parameters, rounding, 3, aim, lmbda)
    assert_close(found, problem.autograd(isa).run(problem.parameters, rounding, 3, aim, lmbda))


def test_bits_of_some_seeds_stand_for_all() -> None:
    """In a step 5 % of many seeds count, the same ones for both."""
    settings = replace(paper_settings(LMBDA, 3, 500), rate_sample=0.3)
    problem = Problem(paper_spec(3, per_seed=1, features=2), 2500, settings)
    native, reference = problem.native(), problem.autograd()
    results = [step.run(problem.parameters, "noise", 3, problem.levels[0], 1.0) for step in (native, reference)]
    assert_close(*results)
    np.testing.assert_allclose(native.seed_bits(), reference.seed_bits(), rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("seeds", [1, 127, 128, 129, 1000])
def test_threads_change_no_bit(seeds: int) -> None:
    problem = Problem(paper_spec(3, per_seed=2, features=4), seeds)
    one, four = (
        problem.native(threads=threads).run(problem.parameters, "noise", 0, problem.levels[0], LMBDA)
        for threads in (1, 4)
    )
    assert one.error == four.error
    assert one.bits == four.bits
    for name, gradient in one.gradients.items():
        np.testing.assert_array_equal(gradient, four.gradients[name])
        assert np.isfinite(gradient).all()


def test_what_it_can_run() -> None:
    settings = paper_settings(LMBDA, 3, 500)
    assert FeatureStep.can_run(paper_spec(3), settings)
    assert not FeatureStep.can_run(default_spec(3), settings)
    assert not FeatureStep.can_run(paper_spec(3), replace(settings, loss="squared"))
    assert not FeatureStep.can_run(paper_spec(3), replace(settings, phases=(*settings.phases, Phase(3, 0, "round"))))


def test_a_picture_with_weights() -> None:
    """|I − T| counts by them; the squares that are reported have none."""
    problem = Problem(SPECS["K = 3, D = 7"])
    rng = np.random.default_rng(6)
    weights = rng.random((HEIGHT, WIDTH), np.float32)
    aim = Level(problem.levels[0].samples, 1.0, weights)
    found = problem.native().run(problem.parameters, "none", 0, aim, 0.0)
    assert_close(found, problem.autograd().run(problem.parameters, "none", 0, aim, 0.0))
    plain = problem.native().run(problem.parameters, "none", 0, problem.levels[0], 0.0)
    assert found.error == pytest.approx(plain.error, rel=1e-6)
    assert not np.allclose(found.gradients["feature"], plain.gradients["feature"])
