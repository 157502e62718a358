import pytest

from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec


@pytest.mark.parametrize(("per_seed", "features"), [(10, 50), (1, 8), (4, 20)])
def test_paper_dimensions(per_seed: int, features: int) -> None:
    spec = paper_spec(3, per_seed, features)
    assert spec.attributes == features + 4 + 2 * per_seed  # paper, section 3.1
    assert [group.name for group in spec.groups] == ["feature", "scales", "offset"]


@pytest.mark.parametrize("channels", [1, 3, 6])
def test_default_dimensions(channels: int) -> None:
    spec = default_spec(channels)
    assert {group.name: group.size for group in spec.groups} == {"colour": channels, "shape": 3, "offset": 2}


@pytest.mark.parametrize("spec", [paper_spec(3), default_spec(4), paper_spec(1, 2, 5)])
def test_groups_are_the_columns_in_coding_order(spec: ModelSpec) -> None:
    columns = [column for group in spec.groups for column in range(spec.attributes)[group.columns]]
    assert columns == list(range(spec.attributes))
    assert {group for step in spec.context.steps for group in step} == {group.name for group in spec.groups}
    assert all(spec.group(group.name) == group for group in spec.groups)
