"""The paper profile's native step against the same model under automatic differentiation, on every instruction set."""

import math
from dataclasses import replace

import numpy as np
import pytest
from feature_problem import CASES, LMBDA, SPECS, Problem, assert_close
from scenes import ISAS

from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.noise import NoiseKey, hashed_noise
from sgicodec.fit.parameters import StepResult
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding
from sgicodec.profiles.paper import paper_settings, paper_spec

SPEC = paper_spec(3, per_seed=3, features=5)


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


def plain_problem() -> tuple[Problem, StepResult, FeatureStep]:
    """Attributes that say nothing of the grid and the context: the last biases of MLP_p alone predict."""
    problem = Problem(SPEC, 9, replace(paper_settings(LMBDA, 3, 500), rate_sample=1.0))
    problem.parameters.context.first[:] = 0.0
    problem.parameters.context.rest[: -2 * SPEC.attributes - 3] = 0.0  # all but the last biases
    step = problem.native()
    return problem, step.run(problem.parameters, "noise", 0, problem.levels[0], LMBDA), step


def test_the_price_of_bits_is_that_of_equation_11() -> None:
    """λ / (N d_A) for each bit of the grid and of the seeds."""
    problem, found, _ = plain_problem()
    context = problem.parameters.context
    gradient, theta = (context.per_table(table)[0] for table in (found.gradients["context.tables"], context.tables))
    share = context.signs()[0].mean()
    slope = 0.5 * math.log2((1 - share) / share)  # of L_hash in one entry's sign, equation 12
    expected = np.where(np.abs(theta) <= 1, LMBDA / (9 * SPEC.attributes) * slope, 0)  # straight through up to 1
    np.testing.assert_allclose(gradient, expected, rtol=1e-4)


def test_bits_are_those_of_the_gaussian_that_mlp_p_predicts() -> None:
    """Equation 10 in plain numbers for seed 0."""
    problem, total, step = plain_problem()
    d = SPEC.attributes
    mean, scale, refine = np.split(problem.parameters.context.rest[-2 * d - 3 :], [d, 2 * d])
    bits, start, coded = 0.0, 0, problem.parameters.seeds.coded()
    for position, (name, base) in enumerate((("feature", 1.0), ("scales", 1.0), ("offset", 2 ** (-14 / 6)))):
        q = base * 2 ** refine[position]
        for j in range(coded[name].shape[1]):
            drawn = coded[name][0, j] + q * hashed_noise(NoiseKey.of(problem.settings.seed, 0), start + j, 9)[0]
            m, s = mean[start + j] * base, base * 2 ** scale[start + j]
            low, high = (0.5 * (1 + math.erf((drawn + side * q - m) / s / 2**0.5)) for side in (-0.5, 0.5))
            bits -= math.log2(max(high - low, 2.0**-20))
        start += coded[name].shape[1]
    assert step.seed_bits()[0] == pytest.approx(bits, rel=5e-4)  # what float32 leaves of the tails
    assert total.bits > step.seed_bits()[0]
