"""What a fit does from step to step, seen on a picture of a few seeds; how its steps are counted, and what is due."""

import math
from collections import deque

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.schedule import Schedule, evenly, passed
from sgicodec.fit.trainer import Trainer
from sgicodec.model.layout import adaptive_layout
from sgicodec.profiles.default import default_settings, default_spec
from sgicodec.profiles.fit_settings import FitSettings, Phase


def small_fit(settings: FitSettings, weights: NDArray[np.float32] | None = None, side: int = 1) -> Trainer:
    """Of random squares of this side."""
    spec = default_spec(3)
    squares = np.random.default_rng(5).normal(size=(3, 48 // side, 64 // side)).astype(np.float32)
    target = 0.1 * squares.repeat(side, axis=1).repeat(side, axis=2)
    return Trainer(spec, settings, target, adaptive_layout(target, 2.0), 1, load_prior(spec), weights=weights)


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


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4))
def test_counted_steps(counts: list[int]) -> None:
    schedule = Schedule(tuple(Phase(count) for count in counts))
    number = 0
    for index, count in enumerate(counts):
        fractions = []
        for fraction in schedule.within(index):
            assert schedule.done == pytest.approx(number / sum(counts))
            assert schedule.steps == sum(counts)
            number += 1
            fractions.append(fraction)
        assert fractions == [(i + 1) / count for i in range(count)]
    assert schedule.done == 1.0


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4), st.integers(0, 12))
def test_what_happens_evenly_is_due_once_each_unless_steps_are_too_few(counts: list[int], times: int) -> None:
    schedule = Schedule(tuple(Phase(count) for count in counts))
    for index, count in enumerate(counts):
        left = evenly(times)
        due = [fraction for fraction in schedule.within(index) if passed(left, fraction)]
        assert due == sorted({math.ceil((i + 1) / (times + 1) * count - 1e-9) / count for i in range(times)})
        assert left == []
