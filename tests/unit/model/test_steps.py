"""The default plan: within the table, and what it says of each profile."""

import pytest

from sgicodec.model.context import LEVELS, output_count
from sgicodec.model.quantization import STEP_COUNT
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan, follows_amplitude
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

SPEC = default_spec(3)


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
