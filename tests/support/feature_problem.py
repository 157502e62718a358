"""The paper profile in the middle of a fit, for its steps on every device."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.device import ONE_THREAD, Device
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import levels_of
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.context import HashGrid
from sgicodec.model.layout import uniform_layout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan
from sgicodec.profiles.fit_settings import FitSettings, Rounding
from sgicodec.profiles.paper import paper_settings, paper_spec
from sgicodec.raster.cpu import NativeRasterizer
from tests.support.torch_step.step import AutogradStep

__all__ = ["CASES", "HEIGHT", "LMBDA", "QUALITY", "SPECS", "WIDTH", "Problem", "assert_close"]

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
        context.tables[:] = rng.normal(0, 1, context.tables.shape)  # beyond ±1, too
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
