"""The paper profile's step on a GPU against the native step, the kernels compiled for the host (fake_cuda.cpp)."""

from __future__ import annotations

import numpy as np
import pytest
from fake_cuda import backwards, fake_gpu
from feature_problem import CASES, HEIGHT, LMBDA, QUALITY, SPECS, WIDTH, Problem, assert_close

from sgicodec.device import ONE_THREAD
from sgicodec.fit.device_feature_step import DeviceFeatureStep
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.parameters import StepResult
from sgicodec.fit.pyramid import Level
from sgicodec.profiles.fit_settings import Rounding
from sgicodec.profiles.paper import paper_spec
from sgicodec.raster.cpu import NativeRasterizer

CUTOFF = 6.0
"""Where what one draws and the other not is below rounding."""


def on_gpu(problem: Problem) -> DeviceFeatureStep:
    step = DeviceFeatureStep(problem.spec, problem.settings, fake_gpu(), (WIDTH, HEIGHT), CUTOFF)
    step.set_layout(problem.layout, QUALITY)
    return step


def native(problem: Problem) -> FeatureStep:
    raster = NativeRasterizer(ONE_THREAD, cutoff=CUTOFF)
    step = FeatureStep(problem.spec, problem.settings, raster, (WIDTH, HEIGHT), ONE_THREAD)
    step.set_layout(problem.layout, QUALITY)
    return step


def run_both(problem: Problem, rounding: Rounding, number: int, level: Level, lmbda: float) -> None:
    steps = on_gpu(problem), native(problem)
    assert_close(*(step.run(problem.parameters, rounding, number, level, lmbda) for step in steps))
    np.testing.assert_allclose(steps[0].seed_bits(), steps[1].seed_bits(), rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(("rounding", "lmbda"), CASES)
@pytest.mark.parametrize("name", SPECS)
def test_it_is_the_native_step(name: str, rounding: Rounding, lmbda: float, level: int) -> None:
    problem = Problem(SPECS[name])
    run_both(problem, rounding, 3, problem.levels[level], lmbda)


def equal(found: StepResult, expected: StepResult) -> None:
    assert (found.error, found.bits) == (expected.error, expected.bits)
    for name, gradient in expected.gradients.items():
        np.testing.assert_array_equal(found.gradients[name], gradient)
        assert np.isfinite(gradient).all()


def test_phases_and_levels_follow_each_other() -> None:
    """What a step leaves on the GPU changes no later one, whatever had room."""
    problem = Problem(paper_spec(3, per_seed=2, features=9), 300)
    step = on_gpu(problem)
    for rounding, lmbda in (*CASES, *reversed(CASES)):
        for level in problem.levels:
            again = on_gpu(problem).run(problem.parameters, rounding, 5, level, lmbda)
            equal(step.run(problem.parameters, rounding, 5, level, lmbda), again)


def test_the_order_of_threads_changes_no_byte() -> None:
    problem = Problem(paper_spec(3, per_seed=2, features=9), 300)
    forwards = on_gpu(problem).run(problem.parameters, "noise", 1, problem.levels[0], LMBDA)
    with backwards():
        equal(on_gpu(problem).run(problem.parameters, "noise", 1, problem.levels[0], LMBDA), forwards)
