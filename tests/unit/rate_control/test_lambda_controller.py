"""λ controller on made-up fits: a plant whose bytes and PSNR follow λ late."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.rate_control.convergence import DONE, expected
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.side_information import SEED_POSITION_BITS
from sgicodec.rate_control.target import Measured, RateTarget

OVERHEAD = 700.0


class Plant:
    """A picture of which a stream at λ has 10,000 (λ / 0.01)^-0.6 bytes of seeds and 30 − 4.5 log10(λ / 0.01) dB.

    The state follows λ with a time constant of 30 steps.
    """

    def __init__(self, steps: int) -> None:
        self.steps, self.octaves, self.lmbda = steps, 0.0, 0.01

    def follow(self, lmbda: float) -> None:
        self.lmbda = lmbda
        self.octaves += (math.log2(lmbda / 0.01) - self.octaves) * min(1.0, 30 / self.steps)

    @property
    def outcome(self) -> Measured:
        return Measured(1e4 * 2 ** (-0.6 * self.octaves) + OVERHEAD, 30 - 4.5 * math.log10(2) * self.octaves)

    def state(self, done: float) -> tuple[float, int, float]:
        """Bits, seeds, PSNR as a fit would report them."""
        seeds = 2000
        ratio, offset = expected(done, self.steps, self.lmbda)
        size = (self.outcome.bytes - OVERHEAD) * ratio
        return 8 * size - SEED_POSITION_BITS * seeds, seeds, self.outcome.psnr + offset


def fitted(target: RateTarget, lmbda: float, steps: int = 1000) -> tuple[Plant, float]:
    plant, controller = Plant(steps), LambdaController(target, lmbda, OVERHEAD)
    plant.octaves = math.log2(lmbda / 0.01)
    for step in range(round(0.2 * steps), steps):
        done = step / steps
        plant.follow(lmbda)
        lmbda = controller.update(done, steps, *plant.state(done))
    return plant, lmbda


@pytest.mark.parametrize("steps", [120, 350, 1000, 4000])
@pytest.mark.parametrize("start", [0.002, 0.01, 0.05])
def test_reaches_a_size(steps: int, start: float) -> None:
    plant, _ = fitted(RateTarget(bytes=12_000), start, steps)
    assert plant.outcome.bytes == pytest.approx(0.99 * 12_000, rel=0.04)


@pytest.mark.parametrize("steps", [120, 350, 1000, 4000])
@pytest.mark.parametrize("start", [0.002, 0.01, 0.05])
def test_reaches_a_psnr(steps: int, start: float) -> None:
    plant, _ = fitted(RateTarget(psnr=31.0), start, steps)
    assert plant.outcome.psnr == pytest.approx(31.0, abs=0.25)


def test_nothing_moves_before_the_jump_nor_at_the_end() -> None:
    controller = LambdaController(RateTarget(bytes=100.0), 0.01, OVERHEAD)
    assert controller.update(0.28, 1000, 1e6, 1000, 30.0) == 0.01
    jumped = controller.update(0.3, 1000, 1e6, 1000, 30.0)
    assert jumped > 0.01
    assert controller.update(0.33, 1000, 1e6, 1000, 30.0) == jumped
    assert controller.update(1.0, 1000, 1e6, 1000, 30.0) == jumped


@given(
    st.floats(1, 1e9) | st.none(),
    st.floats(1, 150),
    st.lists(st.tuples(st.floats(0, 1e12), st.integers(1, 10**7), st.floats(-50, 120)), min_size=1, max_size=20),
)
def test_lmbda_stays_a_sound_number(
    size: float | None, decibels: float, states: list[tuple[float, int, float]]
) -> None:
    """For any state, with a size or a PSNR."""
    target = RateTarget(bytes=size) if size is not None else RateTarget(psnr=decibels)
    controller = LambdaController(target, 0.01, OVERHEAD)
    for at, state in enumerate(states):
        lmbda = controller.update(0.2 + 0.8 * at / len(states), 100, *state)
        assert 1e-6 <= lmbda <= 4.0


def seeds(count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    return np.exp(rng.normal(0, 1.5, count)).astype(np.float32), np.full(count, 25.0, np.float32)


def test_a_size_moves_lmbda_before_pruning_by_what_would_be_left() -> None:
    energy, bits = seeds(20_000)
    price = 30.0
    kept = int(np.sum(energy > price * 0.01))
    size = kept * (25 + SEED_POSITION_BITS) / 8 / expected(DONE[1], 1000, 0.01)[0] + OVERHEAD
    for factor, direction in ((0.5, 1), (0.99**-1, 0), (2.0, -1)):
        controller = LambdaController(RateTarget(bytes=size * factor), 0.01, OVERHEAD)
        moved = math.log2(controller.update_before_pruning(energy, bits, price, 30.0, 1000) / 0.01)
        assert moved == pytest.approx(0.0, abs=0.01) if direction == 0 else 0.5 < moved * direction <= 2.0


def test_a_psnr_moves_lmbda_before_pruning_by_that_under_noise() -> None:
    energy, bits = seeds(5000)
    better, worse = (
        LambdaController(RateTarget(psnr=30.0), 0.01, OVERHEAD).update_before_pruning(energy, bits, 30.0, psnr, 1000)
        for psnr in (33.0, 24.0)
    )
    assert worse < 0.01 < better


def test_lmbda_before_pruning_where_no_seed_is_worth_its_price() -> None:
    energy, bits = seeds(50)
    controller = LambdaController(RateTarget(bytes=200.0), 4.0, OVERHEAD)
    assert 1e-6 <= controller.update_before_pruning(energy * 0, bits, 30.0, 30.0, 1000) <= 4.0
