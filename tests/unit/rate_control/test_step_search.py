"""Step-size search on made-up streams."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from sgicodec.rate_control.step_search import step_shift
from sgicodec.rate_control.target import Measured, RateTarget

Made = Callable[[float], Measured]


def streams(size: float, slope: float, bend: float, decibels: float = 30.0) -> tuple[Made, list[float]]:
    """What streams measure, and of which shifts: log2 of the bytes falls by `slope` a shift, at first."""
    made: list[float] = []

    def finish(shift: float) -> Measured:
        made.append(shift)
        bent = shift - bend * shift * abs(shift) / 200
        return Measured(max(1, round(size * 2.0 ** (-slope * bent))), decibels - 6 * slope * bent)

    return finish, made


@given(st.floats(2e3, 1e6), st.floats(0.01, 0.06), st.floats(-0.5, 0.5), st.floats(-0.8, 0.8))
def test_finds_a_size_within_reach(size: float, slope: float, bend: float, off: float) -> None:
    finish, made = streams(size, slope, bend)
    assume(math.log2(finish(-90).bytes / size) > off > math.log2(finish(90).bytes / size))
    made.clear()
    target = RateTarget(bytes=size * 2.0**off)
    measured = finish(step_shift(target, finish))
    made.pop()
    assert target.bytes is not None
    assert measured.bytes <= target.bytes
    assert measured.bytes >= 0.97 * target.bytes - 1
    assert len(made) <= 8


@given(st.floats(0.004, 0.02), st.floats(-0.5, 0.5), st.floats(-2, 2))
def test_finds_a_psnr_within_reach(slope: float, bend: float, off: float) -> None:
    finish, made = streams(1e5, slope, bend)
    assume(finish(-90).psnr - 30 > off > finish(90).psnr - 30)
    made.clear()
    measured = finish(step_shift(RateTarget(psnr=30 + off), finish))
    made.pop()
    assert 30 + off - 0.1 <= measured.psnr <= 30 + off + 0.1
    assert len(made) <= 8


@given(st.lists(st.tuples(st.integers(1, 5000), st.floats(5, 60) | st.just(math.inf)), min_size=193, max_size=193))
def test_any_streams_end_with_one_that_was_made(table: list[tuple[int, float]]) -> None:
    """Sizes that neither fall nor rise: never one above the target where one below was made, never more than eight."""
    for target in (RateTarget(bytes=700.0), RateTarget(psnr=33.0)):
        seen: dict[float, Measured] = {}

        def finish(shift: float, seen: dict[float, Measured] = seen) -> Measured:
            assert shift not in seen
            seen[shift] = Measured(*table[round(4 * shift) % len(table)])
            return seen[shift]

        measured = seen[step_shift(target, finish)]
        assert len(seen) <= 8
        if target.is_missed(measured):
            assert all(target.is_missed(other) for other in seen.values())


def test_a_psnr_that_goes_up_and_down_is_met() -> None:
    """A tenth of a decibel of noise, as large as what a step takes: a plain secant search misses 61 of 500."""
    missed = 0
    for seed in range(500):
        rng = np.random.default_rng(seed)
        noise, target = rng.normal(0, 0.1, 4 * 193), RateTarget(psnr=32 + rng.uniform(-3, 3))

        def finish(shift: float, noise: np.ndarray = noise) -> Measured:
            return Measured(1000 * 2 ** (-shift / 50), 32 - 0.1 * shift + noise[round(4 * (shift + 96))])

        missed += not target.is_met(finish(step_shift(target, finish)))
    assert missed <= 10


def test_a_stream_that_fits_is_not_made_twice() -> None:
    finish, made = streams(1000, 0.01, 0.0)
    assert step_shift(RateTarget(bytes=1010.0), finish) == 0
    assert made == [0]


def test_what_cannot_be_reached_ends_with_the_nearest() -> None:
    finish, made = streams(1e5, 0.01, 0.0)
    assert step_shift(RateTarget(bytes=100.0), finish) == max(made) == 96
    assert step_shift(RateTarget(psnr=80.0), finish) == min(made) == -96


def test_a_picture_without_any_error() -> None:
    """Infinite PSNR on one side of what was asked for, or on both."""

    def finish(shift: float) -> Measured:
        return Measured(100, math.inf if shift < 40 else 60 - shift / 10)

    assert finish(step_shift(RateTarget(psnr=56.0), finish)).psnr >= 55.9
    assert -96 <= step_shift(RateTarget(psnr=40.0), lambda _: Measured(100, math.inf)) <= 96
