"""Fixed point against exact integer arithmetic."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.model.quantization import (
    DEAD_ZONE_LIMIT,
    FRACTION_BITS,
    PER_OCTAVE,
    STEP_COUNT,
    STEP_ZERO,
    quantize,
    step_fixed,
)

ONE = 1 << FRACTION_BITS


def root(value: int, degree: int) -> int:
    """Floor of the degree-th root, exactly."""
    low, high = 0, 1 << (value.bit_length() // degree + 1)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle**degree <= value else (low, middle)
    return low


def test_steps_are_sixths_of_octaves() -> None:
    index = np.arange(STEP_COUNT)
    fixed = step_fixed(index)
    for i, value in zip(index.tolist(), fixed.tolist(), strict=True):
        exact = root(2 ** (6 * 80 + i - STEP_ZERO), 6) / 2**80  # 2^((i − 96) / 6) in units of 2^-80, from integers
        assert abs(value - exact * ONE) <= 0.5 + 2**-15  # rounded twice: to 2^-40 and to 2^-24
    coarse = index >= STEP_ZERO - 5 * PER_OCTAVE
    np.testing.assert_allclose(fixed[coarse] / ONE, 2.0 ** ((index[coarse] - STEP_ZERO) / 6), rtol=2**-20)
    assert fixed[0] == 256
    assert fixed[STEP_ZERO] == ONE
    assert np.all(np.diff(fixed) > 0)


value = st.floats(-100, 100)
mean = st.integers(-(2**28), 2**28)
index = st.integers(0, STEP_COUNT - 1)
scale = st.integers(0, 63)


@given(value, mean, index, scale)
def test_decisions_lean_towards_zero_and_stay_near(v: float, m: int, i: int, sigma: int) -> None:
    step = step_fixed(np.array([i]))
    symbol = quantize(np.array([v]), np.array([m]), step, np.array([sigma]))
    error = ((m + step[0] * symbol[0]) / ONE - v) / (step[0] / ONE)
    exact = (v - m / ONE) / (step[0] / ONE)
    assert abs(error) <= 0.5 + DEAD_ZONE_LIMIT + 1e-6
    assert abs(symbol[0]) <= abs(exact) + 0.5 + 1e-6
    assert symbol[0] * exact >= 0
    if sigma == 63:  # a wide distribution charges nothing for a larger symbol
        assert abs(error) <= 0.5 + 2e-3


@given(st.integers(-(2**20), 2**20), mean, index, scale)
def test_what_was_decoded_is_coded_the_same_again(n: int, m: int, i: int, sigma: int) -> None:
    step = step_fixed(np.array([i]))
    decoded = np.array([m + int(step[0]) * n])
    assert quantize(decoded / ONE, np.array([m]), step, np.array([sigma])).tolist() == [n]
