"""What a fit does from step to step, seen on a picture of a few seeds; what is due in which."""

import math
from collections import deque
from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.trainer import Trainer, due
from sgicodec.model.layout import adaptive_layout
from sgicodec.profiles.default import default_settings, default_spec
from sgicodec.profiles.fit_settings import FitSettings


def small_fit(settings: FitSettings, weights: NDArray[np.float32] | None = None, side: int = 1) -> Trainer:
    """Of random squares of this side."""
    spec = default_spec(3)
    squares = np.random.default_rng(5).normal(size=(3, 48 // side, 64 // side)).astype(np.float32)
    target = 0.1 * squares.repeat(side, axis=1).repeat(side, axis=2)
    return Trainer(spec, settings, target, adaptive_layout(target, 2.0), load_prior(spec), weights=weights)


def test_every_second_step_mirrors_the_noise_before() -> None:
    keys = [NoiseKey.of(seed, number) for seed in (0, 7) for number in range(12)]
    assert [key.negative for key in keys] == 12 * [False, True]
    assert [key.key for key in keys[0::2]] == [key.key for key in keys[1::2]]
    assert len({key.key for key in keys}) == 12


def test_weights_move_seeds_to_where_errors_count() -> None:
    """The right half counts sixteen times as much: it keeps more seeds and less error."""
    weights = np.ones((48, 64), np.float32)
    weights[:, 32:] = 16.0
    errors, shares = [], []
    for some in (None, weights):
        trainer = small_fit(default_settings(0.01, 120), some, side=8)
        deque(trainer.iterate(), maxlen=0)
        drawn = trainer.raster.forward(*trainer.seeds.gaussians(), 64, 48)
        squares = (trainer.levels[0].samples - drawn)[:, :, 32:] ** 2
        errors.append(float(squares.sum()))
        shares.append(float(np.mean(trainer.seeds.layout.corner[:, 0] >= 32)))
    assert errors[1] < 0.7 * errors[0]
    assert shares[1] > shares[0] + 0.1


@given(st.integers(1, 40), st.integers(0, 12))
def test_what_happens_evenly_is_due_once_each_unless_steps_are_too_few(steps: int, times: int) -> None:
    found = [number for number in range(1, steps + 1) if due(times, number, steps)]
    assert found == sorted({math.ceil(Fraction((i + 1) * steps, times + 1)) for i in range(times)})
