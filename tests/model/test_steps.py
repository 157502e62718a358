"""Step indices against the formula q = Q · amplitude^−γ · 2^r."""

import numpy as np
import pytest

from sgicodec.model.context import LEVELS, output_count
from sgicodec.model.quantize import STEP_COUNT, STEP_ZERO
from sgicodec.model.spec import ModelSpec, default_spec, paper_spec
from sgicodec.model.steps import (
    AMPLITUDE_ZERO,
    GAMMA_BITS,
    REFINE_LIMIT,
    StepPlan,
    default_plan,
    follows_amplitude,
)

SPEC = default_spec(3, per_seed=2)


def test_base_index_follows_the_cell_and_the_column() -> None:
    base = np.arange(3 * LEVELS).reshape(3, LEVELS)
    plan = StepPlan({"colour": base}, {"colour": 0})
    found = plan.base_index(SPEC, "colour", np.array([0, 3, 7, 9], np.int8))
    assert found.shape == (4, 6)
    for row, level in zip(found, (0, 3, 7, 7), strict=True):
        assert row.tolist() == [base[channel, level] for channel in (0, 1, 2, 0, 1, 2)]


@pytest.mark.parametrize("gamma", [0, 8, 16, 25, 63])
def test_refined_index_is_the_formula_rounded_down(gamma: int) -> None:
    rng = np.random.default_rng(gamma)
    plan = StepPlan({}, {"shape": gamma})
    base = rng.integers(0, STEP_COUNT, (500, 3))
    amplitude, refine = rng.integers(-72, 30, 500), rng.integers(-60, 60, 500)
    found = plan.refined_index("shape", base, amplitude, refine)
    bounded = np.clip(refine, -REFINE_LIMIT, REFINE_LIMIT)
    exact = base + (bounded - gamma / 2**GAMMA_BITS * (amplitude - AMPLITUDE_ZERO))[:, None]
    clipped = np.clip(exact, 0, STEP_COUNT - 1)
    assert np.all((found >= clipped - 1e-9) & (found < clipped + 1))  # less is taken away than exact, by under one
    np.testing.assert_array_equal(
        plan.refined_index("shape", base, None, refine), np.clip(base + bounded[:, None], 0, STEP_COUNT - 1)
    )


@pytest.mark.parametrize("spec", [SPEC, default_spec(1), paper_spec(3)])
@pytest.mark.parametrize("quality", [0, 60, STEP_COUNT - 1])
def test_default_plan_fits_the_table(spec: ModelSpec, quality: int) -> None:
    plan = default_plan(spec, quality)
    for group in spec.groups:
        base = plan.base[group.name]
        assert base.shape == (output_count(spec, group.name), LEVELS)
        assert base.min() >= 0
        assert base.max() < STEP_COUNT
        assert 0 <= plan.gamma[group.name] < 64
        assert bool(plan.gamma[group.name]) == follows_amplitude(spec, group.name)


def test_default_plan_by_profile() -> None:
    plan = default_plan(SPEC, 60)
    assert plan.base["colour"][0].tolist() == [78, 72, 66, 60, 54, 48, 42, 36]  # halves when cells double
    assert plan.base["shape"][0, 3] == 86
    paper = default_plan(paper_spec(3), 60)
    assert set(paper.base["feature"].ravel().tolist()) == {STEP_ZERO}  # 1, and 2^(-14/6) = 0.2 for offsets
    assert set(paper.base["offset"].ravel().tolist()) == {STEP_ZERO - 14}
