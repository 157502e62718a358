"""The paper profile's native step against the same model under automatic differentiation, on every instruction set."""

import numpy as np
import pytest
from feature_problem import CASES, LMBDA, SPECS, Problem, assert_close
from scenes import ISAS

from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding
from sgicodec.profiles.paper import paper_spec


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
