"""What a fit does from step to step, seen on a picture of a few seeds."""

from typing import Any

import numpy as np
import pytest

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.fit.fused_step import NoiseKey
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.trainer import Trainer
from sgicodec.model.layout import adaptive_layout
from sgicodec.profiles.default import default_settings, default_spec
from sgicodec.profiles.fit_settings import FitSettings, Rounding

LMBDA, FAMILY = 0.01, 1


def small_fit(settings: FitSettings) -> Trainer:
    spec = default_spec(3, prior=1)
    target = np.random.default_rng(5).normal(size=(3, 48, 64)).astype(np.float32) * 0.1
    return Trainer(spec, settings, target, adaptive_layout(target, 2.0), FAMILY, load_prior(spec))


def test_every_second_step_mirrors_the_noise_before() -> None:
    keys = [NoiseKey.of(seed, number) for seed in (0, 7) for number in range(12)]
    assert [key.negative for key in keys] == 12 * [False, True]
    assert [key.key for key in keys[0::2]] == [key.key for key in keys[1::2]]
    assert len({key.key for key in keys}) == 12


def test_steps_are_numbered_from_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    trainer, seen = small_fit(default_settings(LMBDA, 12)), []
    run = trainer.gradient_step.run

    def spy(parameters: Parameters, rounding: Rounding, number: int, *rest: Any) -> StepResult:
        seen.append(number)
        return run(parameters, rounding, number, *rest)

    monkeypatch.setattr(trainer.gradient_step, "run", spy)
    trainer.run()
    assert seen == list(range(12))
