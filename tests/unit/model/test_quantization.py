"""Fixed point against exact integer arithmetic."""

import numpy as np
from integer_root import root

from sgicodec.model.quantization import FRACTION_BITS, PER_OCTAVE, STEP_COUNT, STEP_ZERO, step_fixed

ONE = 1 << FRACTION_BITS


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
