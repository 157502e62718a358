"""Learning rates over the course of a fit."""

import pytest

from sgicodec.fit.settings import LearningRates, default_settings, paper_settings


def test_linear_decay() -> None:
    rates = LearningRates(hold=0.2, settled=0.8, final=0.1, decay="linear")
    left = [rates.left(done) for done in (0.0, 0.2, 0.4, 0.5, 0.8, 1.0)]
    assert left == pytest.approx([1.0, 1.0, 0.7, 0.55, 0.1, 0.1])


def test_exponential_decay() -> None:
    rates = LearningRates(hold=0.2, settled=0.8, final=0.01, decay="exponential")
    left = [rates.left(done) for done in (0.0, 0.2, 0.5, 0.8, 1.0)]
    assert left == pytest.approx([1.0, 1.0, 0.1, 0.01, 0.01])


def test_the_paper_profile_decays_over_the_whole_fit() -> None:
    rates = paper_settings(0.001, 3, 15_000).rates
    assert [rates.left(done) for done in (0.0, 0.5, 1.0)] == pytest.approx([1.0, 0.1, 0.01])


def test_rates_have_settled_when_values_are_rounded() -> None:
    settings = default_settings(0.006, 1000)
    begin = 1 - settings.phases[-1].steps / settings.steps
    assert settings.rates.left(begin) == pytest.approx(settings.rates.final)
    assert settings.rates.left(begin - 0.1) > settings.rates.final
