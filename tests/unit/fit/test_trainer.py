"""What a fit does from step to step, seen on a picture of a few seeds."""

from typing import Any

import numpy as np
import pytest

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.fit.settings import FitSettings, default_settings
from sgicodec.fit.trainer import Trainer
from sgicodec.model.layout import adaptive_layout
from sgicodec.model.spec import default_spec

LMBDA, FAMILY = 0.01, 1


def small_fit(settings: FitSettings) -> Trainer:
    spec = default_spec(3, prior=1)
    target = np.random.default_rng(5).normal(size=(3, 48, 64)).astype(np.float32) * 0.1
    return Trainer(spec, settings, target, adaptive_layout(target, 2.0), FAMILY, load_prior(spec))


def test_every_second_step_mirrors_the_noise_before(monkeypatch: pytest.MonkeyPatch) -> None:
    trainer = small_fit(default_settings(LMBDA, 12))
    assert trainer.seed_step is not None
    run, seen = trainer.seed_step.run, []

    def spy(*arguments: Any) -> tuple[float, float]:
        seen.append(arguments[4])
        return run(*arguments)

    monkeypatch.setattr(trainer.seed_step, "run", spy)
    trainer.run()
    keys = [noise.key for noise in seen]
    assert [noise.negative for noise in seen] == 6 * [False, True]
    assert keys[0::2] == keys[1::2]
    assert len(set(keys)) == 6
