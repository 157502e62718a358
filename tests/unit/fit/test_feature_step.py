"""The paper profile's native step against the same model under automatic differentiation, on every instruction set."""

from dataclasses import replace

import numpy as np
import pytest
from feature_problem import CASES, HEIGHT, LMBDA, SPECS, WIDTH, Problem, assert_close
from scenes import ISAS

from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.pyramid import Level
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.fit_settings import Phase, Rounding
from sgicodec.profiles.paper import paper_settings, paper_spec


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
