"""What each profile makes of the settings of an encode."""

import pytest

from sgicodec import EncodeSettings
from sgicodec.encoder.effort import VISUAL_STEPS
from sgicodec.errors import UsageError
from sgicodec.profiles.fit_settings import LearningRates
from sgicodec.profiles.paper import paper_settings


def test_rates_hold_and_then_fall_to_what_is_to_be_left() -> None:
    straight = LearningRates(hold=0.4, final=0.01, decay="linear")
    assert [straight.left("offset", done) for done in (0.0, 0.4, 0.7, 1.0)] == pytest.approx([1.0, 1.0, 0.505, 0.01])
    bent = LearningRates(hold=0.5, final=0.01, decay="exponential")
    assert [bent.left("offset", done) for done in (0.0, 0.5, 0.75, 1.0)] == pytest.approx([1.0, 1.0, 0.1, 0.01])
    apart = LearningRates(hold=0.0, decay="exponential", finals={"feature": 1.0, "context": 0.04})
    assert [apart.left("feature", done) for done in (0.0, 0.5, 1.0)] == [1.0, 1.0, 1.0]
    assert [apart.left("context", done) for done in (0.0, 0.5, 1.0)] == pytest.approx([1.0, 0.2, 0.04])
    assert apart.left("offset", 1.0) == pytest.approx(0.01)


def test_scales_of_the_default_profile() -> None:
    """16 steps of quality divide λ by four; λ and steps take the place of quality and effort."""
    coarse, fine = (EncodeSettings(quality=quality, effort=2, seed=7).fit_settings() for quality in (40, 56))
    assert coarse.lmbda == pytest.approx(4 * fine.lmbda)
    assert (coarse.steps, coarse.seed) == (VISUAL_STEPS[2], 7)
    direct = EncodeSettings(lmbda=0.25, steps=77).fit_settings()
    assert (direct.lmbda, direct.steps) == (0.25, 77)


@pytest.mark.parametrize("name", ["seeds", "per_seed", "features", "levels"])
def test_own_choices_are_of_no_other_profile(name: str) -> None:
    with pytest.raises(UsageError, match=f"{name} is a setting of the paper profile"):
        EncodeSettings(**{name: 2})


def lengths(levels: int, steps: int, lmbda: float = 0.001) -> list[tuple[int, int, str, bool]]:
    return [(p.level, p.steps, p.rounding, p.rate) for p in paper_settings(lmbda, levels, steps).phases]


def test_the_published_schedule() -> None:
    """Noise from steps 300, 3,600 and 9,600 on, or 1,500 for M = 1, as published; the rate counts in the last 6,000."""
    assert lengths(3, 15_000) == [
        (2, 300, "none", False),
        (2, 2700, "noise", False),
        (1, 600, "none", False),
        (1, 5400, "noise", False),
        (0, 600, "none", False),
        (0, 5400, "noise", True),
    ]
    assert [count for _, count, _, _ in lengths(1, 15_000)] == [1500, 7500, 6000]
    assert not any(rounding == "noise" for _, _, rounding, _ in lengths(3, 15_000, lmbda=0.0))


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_few_steps_are_made_at_full_size(steps: int) -> None:
    assert sum(count for _, count, _, _ in lengths(3, steps)) >= 1
    assert lengths(3, steps)[-1][0] == 0
