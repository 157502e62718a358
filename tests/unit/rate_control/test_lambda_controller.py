"""λ on its way to a goal, in fits that are made up: a plant whose bytes and PSNR follow λ late and are off at first."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.fit.settings import default_settings
from sgicodec.rate_control.convergence import DONE, POSITION_BITS, course
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.rd_model import initial_lmbda
from sgicodec.rate_control.target import Measured, RateTarget

OVERHEAD = 700.0


class Plant:
    """A picture of which a stream at λ has 10,000 (λ / 0.01)^-0.6 bytes of seeds and 30 − 4.5 log10(λ / 0.01) dB.

    The state follows λ with a time constant of a thirtieth of the fit; `off` multiplies the forecast's bytes.
    """

    def __init__(self, steps: int, off: float = 1.0) -> None:
        self.steps, self.off, self.octaves, self.lmbda = steps, off, 0.0, 0.01

    def follow(self, lmbda: float) -> None:
        self.lmbda = lmbda
        self.octaves += (math.log2(lmbda / 0.01) - self.octaves) * min(1.0, 30 / self.steps)

    @property
    def outcome(self) -> Measured:
        return Measured(1e4 * 2 ** (-0.6 * self.octaves) + OVERHEAD, 30 - 4.5 * math.log10(2) * self.octaves)

    def state(self, done: float) -> tuple[float, int, float]:
        """Bits, seeds, PSNR as a fit would tell them."""
        seeds = 2000
        ratio, lift = course(done, self.steps, self.lmbda)
        size = (self.outcome.bytes - OVERHEAD) * ratio * self.off
        return 8 * size - POSITION_BITS * seeds, seeds, self.outcome.psnr + lift

    def stream(self, done: float) -> Measured:
        """What a real stream of this moment is: `off` is only the forecast's."""
        (ratio, lift), (end, _) = (course(at, self.steps, self.lmbda) for at in (done, 1.0))
        return Measured((self.outcome.bytes - OVERHEAD) * ratio / end + OVERHEAD, self.outcome.psnr + min(0.0, lift))


def fitted(
    goal: RateTarget, lmbda: float, steps: int = 1000, off: float = 1.0, check: bool = False
) -> tuple[Plant, float]:
    plant, controller = Plant(steps, off), LambdaController(goal, lmbda, OVERHEAD)
    plant.octaves = math.log2(lmbda / 0.01)
    checks = [0.15 + 0.82 * at for at in controller.checks]
    for step in range(round(0.2 * steps), steps):
        done = step / steps
        plant.follow(lmbda)
        lmbda = controller.update(done, steps, *plant.state(done))
        if check and checks and done >= checks[0]:
            checks.pop(0)
            controller.correct(done, steps, plant.stream(done))
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


@pytest.mark.parametrize("off", [0.8, 1.25])
def test_real_streams_correct_a_wrong_forecast(off: float) -> None:
    goal = RateTarget(bytes=12_000)
    blind, seeing = (fitted(goal, 0.01, off=off, check=check)[0].outcome.bytes for check in (False, True))
    assert abs(blind - 12_000) > 1_500
    assert seeing == pytest.approx(0.99 * 12_000, rel=0.04)


def test_a_real_stream_is_taken_for_what_it_will_have_become() -> None:
    """A stream halfway that is exactly on course calls for no correction."""
    plant, controller = Plant(1000), LambdaController(RateTarget(psnr=29.9), 0.01, OVERHEAD)
    for step in range(250, 500):
        assert controller.update(step / 1000, 1000, *plant.state(step / 1000)) == pytest.approx(0.01, rel=0.02)
    controller.correct(0.5, 1000, plant.stream(0.5))
    assert controller._correction == pytest.approx(0.0, abs=0.02)


def test_nothing_moves_before_the_leap_nor_at_the_end() -> None:
    controller = LambdaController(RateTarget(bytes=100.0), 0.01, OVERHEAD)
    assert controller.update(0.28, 1000, 1e6, 1000, 30.0) == 0.01
    leapt = controller.update(0.3, 1000, 1e6, 1000, 30.0)
    assert leapt > 0.01
    assert controller.update(0.33, 1000, 1e6, 1000, 30.0) == leapt
    assert controller.update(1.0, 1000, 1e6, 1000, 30.0) == leapt


@given(
    st.floats(1, 1e9) | st.none(),
    st.floats(1, 150),
    st.lists(st.tuples(st.floats(0, 1e12), st.integers(1, 10**7), st.floats(-50, 120)), min_size=1, max_size=20),
    st.floats(1, 1e9),
    st.floats(5, 120) | st.just(math.inf),
)
def test_lmbda_stays_a_sound_number(
    size: float | None, decibels: float, states: list[tuple[float, int, float]], stream: float, quality: float
) -> None:
    """For any state, with a size or a PSNR, and streams without any error."""
    goal = RateTarget(bytes=size) if size is not None else RateTarget(psnr=decibels)
    controller = LambdaController(goal, 0.01, OVERHEAD)
    for at, state in enumerate(states):
        lmbda = controller.update(0.2 + 0.8 * at / len(states), 100, *state)
        controller.correct(0.5, 100, Measured(stream, quality))
        assert 1e-6 <= lmbda <= 4.0


def seeds(count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    return np.exp(rng.normal(0, 1.5, count)).astype(np.float32), np.full(count, 25.0, np.float32)


def test_foresees_a_size_from_what_would_be_left() -> None:
    energy, bits = seeds(20_000)
    price = 30.0
    kept = int(np.sum(energy > price * 0.01))
    size = kept * (25 + POSITION_BITS) / 8 / course(DONE[1], 1000, 0.01)[0] + OVERHEAD
    for factor, direction in ((0.5, 1), (0.99**-1, 0), (2.0, -1)):
        controller = LambdaController(RateTarget(bytes=size * factor), 0.01, OVERHEAD)
        moved = math.log2(controller.update_before_pruning(energy, bits, price, 30.0, 1000) / 0.01)
        assert moved == pytest.approx(0.0, abs=0.01) if direction == 0 else 0.5 < moved * direction <= 2.0


def test_foresees_a_psnr_from_that_under_noise() -> None:
    energy, bits = seeds(5000)
    better, worse = (
        LambdaController(RateTarget(psnr=30.0), 0.01, OVERHEAD).update_before_pruning(energy, bits, 30.0, psnr, 1000)
        for psnr in (33.0, 24.0)
    )
    assert worse < 0.01 < better


def test_foresees_something_where_no_seed_is_worth_its_price() -> None:
    energy, bits = seeds(50)
    controller = LambdaController(RateTarget(bytes=200.0), 4.0, OVERHEAD)
    assert 1e-6 <= controller.update_before_pruning(energy * 0, bits, 30.0, 30.0, 1000) <= 4.0


def detail(seed: int = 0, height: int = 128, width: int = 192) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rough = rng.normal(size=(3, height, width)) * np.linspace(0, 0.2, width) ** 1.5
    return rough.astype(np.float32)


def test_first_lmbda_falls_with_size_and_psnr() -> None:
    settings = default_settings(0.01, 1000)
    sizes = [
        initial_lmbda(RateTarget(bytes=size), detail(), settings.split_price) for size in (500, 1000, 2000, 4000, 8000)
    ]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > 2 * sizes[-1]
    scores = [initial_lmbda(RateTarget(psnr=psnr), detail(), settings.split_price) for psnr in (20, 25, 30, 35)]
    assert scores == sorted(scores, reverse=True)
    assert scores[0] > 2 * scores[-1]


def test_first_lmbda_knows_what_comes_on_top() -> None:
    settings = default_settings(0.01, 1000)
    plain, loaded = (
        initial_lmbda(RateTarget(bytes=4000), detail(), settings.split_price, extra) for extra in (0.0, 2000.0)
    )
    assert loaded == pytest.approx(initial_lmbda(RateTarget(bytes=2000), detail(), settings.split_price), rel=0.2)
    assert loaded > plain


@pytest.mark.parametrize(
    "goal", [RateTarget(bytes=1.0), RateTarget(bytes=1e9), RateTarget(psnr=5.0), RateTarget(psnr=150.0)]
)
@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 16, 16), (2, 70, 5)])
def test_first_lmbda_of_flat_and_tiny_pictures(goal: RateTarget, shape: tuple[int, int, int]) -> None:
    for picture in (np.zeros(shape, np.float32), detail()[: shape[0], : shape[1], : shape[2]]):
        assert 1e-6 <= initial_lmbda(goal, picture, default_settings(0.01, 100).split_price) <= 4.0


def test_goals_and_what_meets_them() -> None:
    size = RateTarget(bytes=1000)
    assert [size.is_met(Measured(b, 0.0)) for b in (969, 970, 1000, 1001)] == [False, True, True, False]
    assert [size.is_missed(Measured(b, 0.0)) for b in (1, 1000, 1001)] == [False, False, True]
    psnr = RateTarget(psnr=30.0)
    assert [psnr.is_met(Measured(1, p)) for p in (29.89, 29.91, 30.09, 30.11)] == [False, True, True, False]
    assert [psnr.is_missed(Measured(1, p)) for p in (29.89, 29.91, 60.0, math.inf)] == [True, False, False, False]
    assert size.rate_error(Measured(990, 0.0)) == pytest.approx(0.0)
    assert size.rate_error(Measured(1200, 0.0)) > 0 > size.rate_error(Measured(800, 0.0))
    assert psnr.rate_error(Measured(1, 30.0)) == 0.0
    assert 0 < psnr.rate_error(Measured(1, math.inf)) < math.inf
