"""How learning rates fall."""

import pytest

from sgicodec.fit.settings import LearningRates, default_settings, paper_settings


def test_rates_hold_and_then_fall_to_what_is_to_be_left() -> None:
    straight = LearningRates(hold=0.4, final=0.01, decay="linear")
    assert [straight.left(done) for done in (0.0, 0.4, 0.7, 1.0)] == pytest.approx([1.0, 1.0, 0.505, 0.01])
    bent = LearningRates(hold=0.5, final=0.01, decay="exponential")
    assert [bent.left(done) for done in (0.0, 0.5, 0.75, 1.0)] == pytest.approx([1.0, 1.0, 0.1, 0.01])


def test_short_fits_have_greater_rates() -> None:
    assert default_settings(0.01, 1000).slowing(3200) == pytest.approx(0.5)
    assert default_settings(0.01, 1000).slowing(800) == pytest.approx(1.0)
    assert default_settings(0.01, 1000).slowing(50) == pytest.approx(2.0)
    assert paper_settings(0.01, 2, 1000).slowing(50) == 1.0
